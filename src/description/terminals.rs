//! `terminalsAndIcons/terminalsAndIcons.xml`: which variables belong to one physical port, and
//! where hosts draw it. The format is that of FMI 3.0, section 2.4.9, to which FMI 2.0.4 refers.

use serde::Serialize;

use super::schema::Number;
use crate::model::Model;
use crate::model::variables::{Member, Terminal as Port};

/// Half the width of the icon, in units of its coordinates.
const EDGE: f64 = 100.0;

/// Half the width of a terminal.
const HALF: f64 = 10.0;

/// Members are connected by their names, and those that the other side does not have are left
/// open: a source imposes one of voltage, current and charge.
const MATCHING_RULE: &str = "bus";

/// The terminals of a model, each once, in the order of its table.
#[must_use]
pub fn all<M: Model>() -> Vec<&'static Port> {
    let mut ports: Vec<&Port> = Vec::new();
    for Member { terminal, .. } in M::VARIABLES.iter().filter_map(|row| row.member) {
        if ports.iter().all(|known| known.name != terminal.name) {
            ports.push(terminal);
        }
    }
    ports
}

/// The text of the file; none where the model has no terminals.
#[must_use]
pub fn xml<M: Model>() -> Option<String> {
    let ports = all::<M>();
    if ports.is_empty() {
        return None;
    }
    let icon = Area::around([0.0, 0.0], EDGE);
    let content = TerminalsAndIcons {
        fmi_version: "3.0",
        graphical_representation: GraphicalRepresentation {
            coordinate_system: CoordinateSystem {
                area: icon,
                suggested_scaling_factor: Number(0.1),
            },
            icon,
        },
        terminals: Terminals {
            terminal: ports.into_iter().map(terminal::<M>).collect(),
        },
    };
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    // As in the model description, nothing here can fail, and a test reads it back.
    let written = content.serialize(serializer);
    debug_assert!(written.is_ok(), "{written:?}");
    text.push('\n');
    Some(text)
}

fn terminal<M: Model>(port: &'static Port) -> Terminal {
    let of_port = |member: &Member| member.terminal.name == port.name;
    let [red, green, blue] = port.colour;
    Terminal {
        name: port.name,
        matching_rule: MATCHING_RULE,
        description: port.description,
        members: M::VARIABLES
            .iter()
            .filter_map(|row| Some((row.name, row.member.filter(of_port)?)))
            .map(|(variable_name, member)| TerminalMemberVariable {
                variable_name,
                member_name: member.name,
                variable_kind: if member.flows { "inflow" } else { "signal" },
            })
            .collect(),
        representation: TerminalGraphicalRepresentation {
            colour: format!("{red} {green} {blue}"),
            area: Area::around(port.place, HALF),
            icon_base_name: port.name,
        },
    }
}

#[derive(Serialize)]
#[serde(rename = "fmiTerminalsAndIcons")]
struct TerminalsAndIcons {
    #[serde(rename = "@fmiVersion")]
    fmi_version: &'static str,
    #[serde(rename = "GraphicalRepresentation")]
    graphical_representation: GraphicalRepresentation,
    #[serde(rename = "Terminals")]
    terminals: Terminals,
}

#[derive(Serialize)]
struct GraphicalRepresentation {
    #[serde(rename = "CoordinateSystem")]
    coordinate_system: CoordinateSystem,
    #[serde(rename = "Icon")]
    icon: Area,
}

#[derive(Serialize)]
struct CoordinateSystem {
    #[serde(flatten)]
    area: Area,
    #[serde(rename = "@suggestedScalingFactorTo_mm")]
    suggested_scaling_factor: Number,
}

/// A rectangle: lower left and upper right corner.
#[derive(Clone, Copy, Serialize)]
struct Area {
    #[serde(rename = "@x1", serialize_with = "number")]
    left: f64,
    #[serde(rename = "@y1", serialize_with = "number")]
    bottom: f64,
    #[serde(rename = "@x2", serialize_with = "number")]
    right: f64,
    #[serde(rename = "@y2", serialize_with = "number")]
    top: f64,
}

fn number<S: serde::Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Number(*value).serialize(serializer)
}

impl Area {
    /// A square around a point.
    fn around([right, up]: [f64; 2], half: f64) -> Area {
        Area {
            left: right - half,
            bottom: up - half,
            right: right + half,
            top: up + half,
        }
    }
}

#[derive(Serialize)]
struct Terminals {
    #[serde(rename = "Terminal")]
    terminal: Vec<Terminal>,
}

#[derive(Serialize)]
struct Terminal {
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "@matchingRule")]
    matching_rule: &'static str,
    #[serde(rename = "@description")]
    description: &'static str,
    #[serde(rename = "TerminalMemberVariable")]
    members: Vec<TerminalMemberVariable>,
    #[serde(rename = "TerminalGraphicalRepresentation")]
    representation: TerminalGraphicalRepresentation,
}

#[derive(Serialize)]
struct TerminalMemberVariable {
    #[serde(rename = "@variableName")]
    variable_name: &'static str,
    #[serde(rename = "@memberName")]
    member_name: &'static str,
    #[serde(rename = "@variableKind")]
    variable_kind: &'static str,
}

#[derive(Serialize)]
struct TerminalGraphicalRepresentation {
    #[serde(rename = "@defaultConnectionColor")]
    colour: String,
    #[serde(flatten)]
    area: Area,
    #[serde(rename = "@iconBaseName")]
    icon_base_name: &'static str,
}
