//! Variables with any texts and numbers: what the writer of `modelDescription.xml` writes, the
//! reader of the crate `fmi`, which knows nothing of it, reads back, and a reader of XML what that one leaves out.
#![no_main]
#![allow(dead_code)]
#![expect(unsafe_code, reason = "the texts of a table live for ever")]

#[path = "../../src/description/schema.rs"]
mod schema;
#[path = "../../src/shortest.rs"]
mod shortest;

use fmi::fmi2::schema::{ScalarVariable as Read, ScalarVariableElement};
use quick_xml::XmlVersion;
use quick_xml::events::Event;
use schema::{Number, Real, ScalarVariable};
use serde::Serialize;

libfuzzer_sys::fuzz_target!(
    |input: (f64, f64, Option<u32>, Option<bool>, u32, &str, &str)| {
        let (start, min, derivative, reinit, value_reference, name, description) = input;
        let texts = [name, description].map(legal);
        let [name, description]: [&'static str; 2] = texts
            .each_ref()
            // SAFETY: the writer takes texts of the table only, which live for ever; it has returned
            // before these are dropped.
            .map(|text| unsafe { &*(text.as_str() as *const str) });
        let variable = ScalarVariable {
            name,
            value_reference,
            description,
            causality: "local",
            variability: "continuous",
            initial: Some("calculated"),
            real: Some(Real {
                unit: name,
                display_unit: Some(description),
                min: Some(Number(min)),
                max: Some(Number(-min)),
                nominal: Number(start),
                start: Some(Number(start)),
                derivative,
                reinit,
            }),
            boolean: None,
            enumeration: None,
        };
        let mut text = String::new();
        let mut serializer = quick_xml::se::Serializer::new(&mut text);
        serializer.indent(' ', 2);
        variable
            .serialize(serializer)
            .expect("everything can be written");

        let read: Read =
            fmi::schema::deserialize(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
        assert_eq!(
            (read.name.as_str(), read.description.as_deref()),
            (name, Some(description)),
            "{text}"
        );
        assert_eq!(read.value_reference, value_reference);
        let ScalarVariableElement::Real(real) = read.elem else {
            panic!("no Real: {text}");
        };
        let read = real.start.expect("a start");
        assert!(are_same(read, start), "{text}");
        for (key, value) in [("min", min), ("max", -min), ("nominal", start)] {
            let read = attribute(&text, key).parse().expect("a number");
            assert!(are_same(read, value), "{key}: {text}");
        }
        for (key, value) in [("unit", name), ("displayUnit", description)] {
            assert_eq!(attribute(&text, key), value, "{text}");
        }
        assert_eq!(
            (real.derivative, real.reinit),
            (derivative, reinit),
            "{text}"
        );
    }
);

fn are_same(read: f64, written: f64) -> bool {
    read.to_bits() == written.to_bits() || read.is_nan() && written.is_nan()
}

/// An attribute of the element `Real`.
fn attribute(text: &str, key: &str) -> String {
    let mut reader = quick_xml::Reader::from_str(text);
    loop {
        match reader.read_event().expect("XML") {
            Event::Start(element) | Event::Empty(element) if element.name().as_ref() == "Real" => {
                let found = element.try_get_attribute(key).expect("attributes");
                let value = found.expect(key).normalized_value(XmlVersion::Implicit1_0);
                return value.expect("a text").into_owned();
            }
            Event::Eof => panic!("no Real: {text}"),
            _ => {}
        }
    }
}

/// Without what XML cannot hold or may replace by a blank.
fn legal(text: &str) -> String {
    text.chars()
        .filter(|&c| c >= ' ' && !('\u{fffe}'..='\u{ffff}').contains(&c))
        .collect()
}
