//! The C functions of `DielectricElastomerActuator.fmu`, the nondimensional actuator.
#![allow(non_snake_case)] // the names of the standard

dielectric_elastomer_actuator::export_fmi2!(
    dielectric_elastomer_actuator::nondimensional::Nondimensional
);
