//! Units of measurement, as FMI describes them: exponents of the SI base units,
//! a factor, and units in which a value may be displayed.

/// A unit.
#[derive(Debug, PartialEq)]
pub struct Unit {
    /// Its name in the model description.
    pub name: &'static str,
    /// Its SI base units and their exponents, by the names of FMI (`kg`, `m`, `s`, `A`, `rad`).
    pub base: &'static [(&'static str, i32)],
    /// Units in which a value may be displayed; the first is proposed.
    pub displayed: &'static [DisplayUnit],
}

/// A unit in which a value may be displayed.
#[derive(Debug, PartialEq)]
pub struct DisplayUnit {
    /// Its name.
    pub name: &'static str,
    /// How many of it are one of the unit.
    pub factor: f64,
}

/// A pure number.
pub static ONE: Unit = Unit {
    name: "1",
    base: &[],
    displayed: &[],
};

/// Radian, to be displayed in degrees.
pub static ANGLE: Unit = Unit {
    name: "rad",
    base: &[("rad", 1)],
    displayed: &[DisplayUnit {
        name: "deg",
        factor: 180.0 / std::f64::consts::PI,
    }],
};

/// Radians per nondimensional unit of time: FMI's name of the unit is that of the angle.
pub static ANGULAR_FREQUENCY: Unit = Unit {
    name: "rad",
    base: &[("rad", 1)],
    displayed: &[],
};
