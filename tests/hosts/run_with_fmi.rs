//! The motion of a scene as the crate `fmi` computes it, which loads the packed FMU:
//! `run_with_fmi FMU STEP STEPS SWITCH PHI_THEN OUTPUTS NAME=VALUE...` prints a row for each
//! communication point (see `run_in_host.py`).

use std::error::Error;

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common};
use fmi::import;
use fmi::traits::FmiImport;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [fmu, step, steps, switch, phi_then, outputs, scene @ ..] = arguments.as_slice() else {
        return Err("six arguments or more are needed".into());
    };
    let (step, phi_then): (f64, f64) = (step.parse()?, phi_then.parse()?);
    let (steps, switch): (u32, u32) = (steps.parse()?, switch.parse()?);
    let fmu: Fmi2Import = import::from_path(fmu)?;
    let reference = |name: &str| -> Result<u32, String> {
        let mut variables = fmu.model_description().model_variables.variables.iter();
        let found = variables.find(|variable| variable.name == name);
        Ok(found
            .ok_or_else(|| format!("no variable {name}"))?
            .value_reference)
    };
    let outputs: Vec<u32> = outputs
        .split(',')
        .map(&reference)
        .collect::<Result<_, _>>()?;
    let mut values = vec![0.0; outputs.len()];
    let print = |row: &[f64]| {
        let row: Vec<String> = row.iter().map(|value| format!("{value:?}")).collect();
        println!("row {}", row.join(" "));
    };

    let mut instance = fmu.instantiate_cs("actuator", false, false)?;
    instance.setup_experiment(None, 0.0, None)?;
    instance.enter_initialization_mode()?;
    for setting in scene {
        let (name, value) = setting.split_once('=').ok_or("a setting is NAME=VALUE")?;
        instance.set_real(&[reference(name)?], &[value.parse()?])?;
    }
    instance.exit_initialization_mode()?;
    instance.get_real(&outputs, &mut values)?;
    print(&values);
    for k in 0..steps {
        if k == switch {
            instance.set_real(&[reference("phi")?], &[phi_then])?;
        }
        instance.do_step(f64::from(k) * step, step, true)?;
        instance.get_real(&outputs, &mut values)?;
        print(&values);
    }
    instance.terminate()?;
    Ok(())
}
