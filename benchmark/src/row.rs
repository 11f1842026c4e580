//! A row of output; the caller adds case and round.

/// What came out of one measurement.
pub struct Row<'a> {
    pub method: &'a str,
    /// The tolerance asked for.
    pub tolerance: f64,
    /// Communication step; `None` where the run is free.
    pub step: Option<f64>,
    /// What happens to the inputs at each step.
    pub inputs: &'a str,
    /// Nanoseconds for each unit of time, or for each call.
    pub nanoseconds: Option<f64>,
    pub error: Option<f64>,
    /// Difference from the motion under the drive that the inputs follow.
    pub hold_error: Option<f64>,
    pub note: String,
}

impl Row<'_> {
    pub fn print(&self) {
        let text = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.4e}"));
        println!(
            "{},{:e},{},{},{},{},{},{}",
            plain(self.method),
            self.tolerance,
            self.step.map_or(String::new(), |v| format!("{v}")),
            plain(self.inputs),
            text(self.nanoseconds),
            text(self.error),
            text(self.hold_error),
            plain(&self.note),
        );
    }
}

/// A text as a cell.
fn plain(text: &str) -> String {
    format!("\"{}\"", text.replace(['"', '\n'], ";"))
}
