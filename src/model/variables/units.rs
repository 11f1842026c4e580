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

/// Volt.
pub static VOLT: Unit = Unit {
    name: "V",
    base: &[("kg", 1), ("m", 2), ("s", -3), ("A", -1)],
    displayed: &[DisplayUnit {
        name: "kV",
        factor: 1e-3,
    }],
};

/// Ampere.
pub static AMPERE: Unit = Unit {
    name: "A",
    base: &[("A", 1)],
    displayed: &[
        DisplayUnit {
            name: "uA",
            factor: 1e6,
        },
        DisplayUnit {
            name: "mA",
            factor: 1e3,
        },
    ],
};

/// Coulomb.
pub static COULOMB: Unit = Unit {
    name: "C",
    base: &[("A", 1), ("s", 1)],
    displayed: &[DisplayUnit {
        name: "nC",
        factor: 1e9,
    }],
};

/// Newton.
pub static NEWTON: Unit = Unit {
    name: "N",
    base: &[("kg", 1), ("m", 1), ("s", -2)],
    displayed: &[DisplayUnit {
        name: "mN",
        factor: 1e3,
    }],
};

/// Metre.
pub static METRE: Unit = Unit {
    name: "m",
    base: &[("m", 1)],
    displayed: &[
        DisplayUnit {
            name: "um",
            factor: 1e6,
        },
        DisplayUnit {
            name: "mm",
            factor: 1e3,
        },
    ],
};

/// Metre per second.
pub static METRE_PER_SECOND: Unit = Unit {
    name: "m/s",
    base: &[("m", 1), ("s", -1)],
    displayed: &[],
};

/// Metre per second squared.
pub static METRE_PER_SECOND_SQUARED: Unit = Unit {
    name: "m/s2",
    base: &[("m", 1), ("s", -2)],
    displayed: &[],
};

/// Second.
pub static SECOND: Unit = Unit {
    name: "s",
    base: &[("s", 1)],
    displayed: &[
        DisplayUnit {
            name: "ms",
            factor: 1e3,
        },
        DisplayUnit {
            name: "us",
            factor: 1e6,
        },
    ],
};

/// Per second.
pub static PER_SECOND: Unit = Unit {
    name: "1/s",
    base: &[("s", -1)],
    displayed: &[],
};

/// Per second squared.
pub static PER_SECOND_SQUARED: Unit = Unit {
    name: "1/s2",
    base: &[("s", -2)],
    displayed: &[],
};

/// Hertz.
pub static HERTZ: Unit = Unit {
    name: "Hz",
    base: &[("s", -1)],
    displayed: &[DisplayUnit {
        name: "kHz",
        factor: 1e-3,
    }],
};

/// Pascal.
pub static PASCAL: Unit = Unit {
    name: "Pa",
    base: &[("kg", 1), ("m", -1), ("s", -2)],
    displayed: &[
        DisplayUnit {
            name: "MPa",
            factor: 1e-6,
        },
        DisplayUnit {
            name: "kPa",
            factor: 1e-3,
        },
    ],
};

/// Kilogram per cubic metre.
pub static KILOGRAM_PER_CUBIC_METRE: Unit = Unit {
    name: "kg/m3",
    base: &[("kg", 1), ("m", -3)],
    displayed: &[],
};

/// Newton per metre.
pub static NEWTON_PER_METRE: Unit = Unit {
    name: "N/m",
    base: &[("kg", 1), ("s", -2)],
    displayed: &[],
};

/// Newton second per metre.
pub static NEWTON_SECOND_PER_METRE: Unit = Unit {
    name: "N.s/m",
    base: &[("kg", 1), ("s", -1)],
    displayed: &[],
};

/// Pascal second.
pub static PASCAL_SECOND: Unit = Unit {
    name: "Pa.s",
    base: &[("kg", 1), ("m", -1), ("s", -1)],
    displayed: &[],
};

/// Kilogram.
pub static KILOGRAM: Unit = Unit {
    name: "kg",
    base: &[("kg", 1)],
    displayed: &[DisplayUnit {
        name: "g",
        factor: 1e3,
    }],
};

/// Ohm.
pub static OHM: Unit = Unit {
    name: "Ohm",
    base: &[("kg", 1), ("m", 2), ("s", -3), ("A", -2)],
    displayed: &[DisplayUnit {
        name: "kOhm",
        factor: 1e-3,
    }],
};

/// Siemens.
pub static SIEMENS: Unit = Unit {
    name: "S",
    base: &[("kg", -1), ("m", -2), ("s", 3), ("A", 2)],
    displayed: &[DisplayUnit {
        name: "nS",
        factor: 1e9,
    }],
};

/// Siemens per metre.
pub static SIEMENS_PER_METRE: Unit = Unit {
    name: "S/m",
    base: &[("kg", -1), ("m", -3), ("s", 3), ("A", 2)],
    displayed: &[],
};

/// Farad.
pub static FARAD: Unit = Unit {
    name: "F",
    base: &[("kg", -1), ("m", -2), ("s", 4), ("A", 2)],
    displayed: &[
        DisplayUnit {
            name: "nF",
            factor: 1e9,
        },
        DisplayUnit {
            name: "pF",
            factor: 1e12,
        },
    ],
};

/// Volt per metre.
pub static VOLT_PER_METRE: Unit = Unit {
    name: "V/m",
    base: &[("kg", 1), ("m", 1), ("s", -3), ("A", -1)],
    displayed: &[DisplayUnit {
        name: "V/um",
        factor: 1e-6,
    }],
};

/// Watt.
pub static WATT: Unit = Unit {
    name: "W",
    base: &[("kg", 1), ("m", 2), ("s", -3)],
    displayed: &[DisplayUnit {
        name: "mW",
        factor: 1e3,
    }],
};

/// Joule.
pub static JOULE: Unit = Unit {
    name: "J",
    base: &[("kg", 1), ("m", 2), ("s", -2)],
    displayed: &[DisplayUnit {
        name: "mJ",
        factor: 1e3,
    }],
};
