//! The C functions of `DielectricElastomerActuatorSI.fmu`, the real actuator in SI units.
#![allow(non_snake_case)] // the names of the standard

dielectric_elastomer_actuator::export_fmi2!(dielectric_elastomer_actuator::si::Si);
