//! Random scripts of calls, in and out of order, valid and hostile, each played
//! in another process: a crash or a hang is a failing test with its script.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Read, Write, stdin, stdout};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{TestCaseError, TestRunner};

use super::script::{Act, Script, play, time_unit};
use super::*;
use dielectric_elastomer_actuator::model::variables::Kind;
use dielectric_elastomer_actuator::si::Si;

/// The test below that plays in another process.
const PLAYER: &str = "calls::random::plays_for_the_tests";

/// Set in that process: the identifier of the model.
const ROLE: &str = "DEA_TEST_ROLE";

/// After which a script hangs. It takes milliseconds; the rest is for a busy machine.
const PATIENCE: Duration = Duration::from_secs(300);
const ANSWER: &str = "played: ";

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -2.0..2.0_f64,
        2 => 0.0..0.5_f64,
        1 => prop::num::f64::ANY,
        1 => select(vec![0.0, -0.0, 1e-310, 1e3, -1e3, 1e6, f64::MAX, f64::NAN, f64::INFINITY]),
    ]
}

fn whole() -> impl Strategy<Value = i32> {
    prop_oneof![4 => -1..4, 1 => any::<i32>()]
}

fn reference<M: Model>() -> impl Strategy<Value = u32> {
    prop_oneof![12 => 0..M::VARIABLES.len() as u32, 1 => any::<u32>()]
}

/// A number for a variable of its typical size.
fn setting<M: Model>() -> impl Strategy<Value = (u32, f64)> {
    (reference::<M>(), number()).prop_map(|(reference, number)| {
        let row = M::VARIABLES.get(reference as usize);
        match row.map(|row| row.kind) {
            Some(Kind::Real { nominal, .. }) => (reference, number * nominal),
            _ => (reference, number),
        }
    })
}

fn some<T: std::fmt::Debug>(item: impl Strategy<Value = T>) -> impl Strategy<Value = Vec<T>> {
    prop::collection::vec(item, 0..4)
}

/// The calls that lead on in the standard's order, more often than chance would.
fn leading_on<M: Model>() -> impl Strategy<Value = Act> {
    let unit = time_unit::<M>();
    let step = prop_oneof![6 => (0.001..3.0_f64).prop_map(move |step| step * unit), 1 => number()];
    let at = prop_oneof![9 => Just(None), 1 => number().prop_map(Some)];
    prop_oneof![
        2 => Just(Act::EnterInitialization),
        3 => Just(Act::ExitInitialization),
        2 => Just(Act::EnterContinuous),
        1 => Just(Act::EnterEvent),
        1 => Just(Act::NewDiscreteStates),
        6 => (at, step, any::<bool>()).prop_map(|(at, step, back)| Act::Step(at, step, back)),
        3 => number().prop_map(Act::SetTime),
        3 => prop::collection::vec(number(), M::STATES.len()).prop_map(Act::SetStates),
    ]
}

fn values<M: Model>() -> impl Strategy<Value = Act> {
    let orders = || prop_oneof![6 => 1..5, 1 => any::<i32>()];
    prop_oneof![
        4 => some(reference::<M>()).prop_map(Act::GetReal),
        6 => some(setting::<M>()).prop_map(Act::SetReal),
        1 => (any::<bool>(), some(reference::<M>())).prop_map(|(b, r)| Act::GetWhole(b, r)),
        2 => (any::<bool>(), some((reference::<M>(), whole()))).prop_map(|(b, v)| Act::SetWhole(b, v)),
        1 => some(reference::<M>()).prop_map(Act::Strings),
        3 => some((0..3_u32, orders(), number())).prop_map(Act::SetInputDerivatives),
        2 => some((reference::<M>(), orders())).prop_map(Act::GetOutputDerivatives),
        2 => (some(reference::<M>()), some((reference::<M>(), number())))
            .prop_map(|(unknown, known)| Act::GetDirectional(unknown, known)),
    ]
}

fn states() -> impl Strategy<Value = Act> {
    let slot = 0..script::SLOTS;
    let length = prop_oneof![3 => Just(None), 1 => any::<u16>().prop_map(Some)];
    let changes = some((any::<u16>(), any::<u8>()));
    prop_oneof![
        3 => slot.clone().prop_map(Act::Save),
        3 => slot.clone().prop_map(Act::Restore),
        1 => slot.clone().prop_map(Act::Free),
        2 => (slot.clone(), slot, changes, length, any::<bool>())
            .prop_map(|(from, to, changes, length, sealed)| {
                Act::Damage(from, to, changes, length, sealed)
            }),
    ]
}

fn others<M: Model>() -> impl Strategy<Value = Act> {
    let option = || prop::option::of(number());
    let right = [M::STATES.len() as u8, M::INDICATOR_COUNT as u8];
    let count = move || prop_oneof![4 => select(right.to_vec()), 1 => 0..8_u8];
    prop_oneof![
        Just(Act::Renew),
        (any::<bool>(), some(0..5_u8)).prop_map(|(on, names)| Act::SetLogging(on, names)),
        (option(), number(), option())
            .prop_map(|(tolerance, start, stop)| { Act::SetupExperiment(tolerance, start, stop) }),
        Just(Act::Terminate),
        Just(Act::Reset),
        Just(Act::Cancel),
        (any::<u8>(), whole()).prop_map(|(function, kind)| Act::GetStatus(function, kind)),
        any::<bool>().prop_map(Act::CompletedStep),
        count().prop_map(Act::GetDerivatives),
        count().prop_map(Act::GetIndicators),
        count().prop_map(Act::GetStates),
        count().prop_map(Act::GetNominals),
        any::<u8>().prop_map(Act::Null),
    ]
}

fn scripts<M: Model>() -> impl Strategy<Value = Script> {
    let act =
        prop_oneof![4 => leading_on::<M>(), 4 => values::<M>(), 2 => states(), 2 => others::<M>()];
    prop::collection::vec((prop::bool::weighted(0.3), act), 1..60)
}

/// Another process that plays scripts of a model.
struct Player {
    model: &'static str,
    process: Child,
    /// What it prints, line by line.
    lines: Receiver<String>,
}

impl Player {
    fn of<M: Model>() -> Player {
        Player::named(M::IDENTIFIER)
    }

    fn named(model: &'static str) -> Player {
        let mut process = Command::new(std::env::current_exe().expect("a running test"))
            .args([PLAYER, "--exact", "--nocapture", "--test-threads=1"])
            .env(ROLE, model)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the test starts again");
        let output = BufReader::new(process.stdout.take().expect("piped"));
        let (send, lines) = channel();
        thread::spawn(move || {
            let whole = output.lines().map_while(Result::ok);
            whole
                .take_while(|line| send.send(line.clone()).is_ok())
                .count()
        });
        Player {
            model,
            process,
            lines,
        }
    }

    /// Has a script played.
    fn play(&mut self, script: &Script) -> Result<(), String> {
        let bytes = postcard::to_stdvec(script).expect("plain data");
        let input = self.process.stdin.as_mut().expect("piped");
        let length = (bytes.len() as u32).to_le_bytes();
        let sent = input.write_all(&[&length, bytes.as_slice()].concat());
        let mut hangs = false;
        while sent.is_ok() {
            match self.lines.recv_timeout(PATIENCE) {
                Ok(line) => match line.split_once(ANSWER).map(|(_, answer)| answer.trim_end()) {
                    Some("well") => return Ok(()),
                    Some(fault) => return Err(fault.to_owned()),
                    None => {}
                },
                Err(reason) => {
                    hangs = reason == RecvTimeoutError::Timeout;
                    break;
                }
            }
        }
        if hangs {
            self.process.kill().expect("a process of ours");
        }
        let end = self.process.wait().expect("a process of ours");
        *self = Player::named(self.model);
        Err(if hangs {
            format!("it was not played within {PATIENCE:?}")
        } else {
            format!("the process ended: {end}")
        })
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        // Without input it ends by itself.
        self.process.stdin = None;
        self.process.wait().ok();
    }
}

/// The other process; by itself no test, so that it passes where it has no role.
#[test]
fn plays_for_the_tests() {
    let Ok(model) = std::env::var(ROLE) else {
        return;
    };
    let play = if model == Si::IDENTIFIER {
        play::<Si>
    } else {
        play::<Nondimensional>
    };
    let (mut input, mut length) = (stdin().lock(), [0; 4]);
    while input.read_exact(&mut length).is_ok() {
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize];
        input.read_exact(&mut bytes).expect("a whole script");
        let script: Script = postcard::from_bytes(&bytes).expect("a script");
        let answer = play(&script).err().unwrap_or_else(|| "well".into());
        writeln!(stdout(), "\n{ANSWER}{}", answer.replace('\n', " ")).expect("a listener");
    }
}

/// Whatever is called, the answer is as it has to be (see `Act` and `play`).
/// `SOAK=long` plays fifty times as many scripts.
fn random_calls_are_answered<M: Model>() {
    let long = std::env::var("SOAK").is_ok_and(|form| form == "long");
    let config = ProptestConfig {
        cases: if long { 50_000 } else { 1_000 },
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let (player, calls) = (RefCell::new(Player::of::<M>()), RefCell::new(0));
    let outcome = TestRunner::new(config).run(&scripts::<M>(), |script| {
        *calls.borrow_mut() += script.len();
        let played = player.borrow_mut().play(&script);
        played.map_err(|fault| {
            // For the fuzzer's corpus.
            let folder = env!("CARGO_TARGET_TMPDIR");
            let file = format!("{folder}/failing-script-{}", M::IDENTIFIER);
            std::fs::write(&file, fuzzed(&script)).ok();
            TestCaseError::fail(format!("{fault} (script in {file})"))
        })
    });
    println!("{} calls", calls.borrow());
    outcome.unwrap_or_else(|fault| panic!("{fault}"));
}

#[test]
fn random_calls_of_the_papers_model_are_answered() {
    random_calls_are_answered::<Nondimensional>();
}

#[test]
fn random_calls_of_the_real_actuator_are_answered() {
    random_calls_are_answered::<Si>();
}

/// A script as the fuzzer's target takes it: acts one after the other.
fn fuzzed(script: &Script) -> Vec<u8> {
    let bytes = script
        .iter()
        .map(|act| postcard::to_stdvec(act).expect("plain data"));
    bytes.flatten().collect()
}

#[test]
fn the_end_of_the_process_is_noticed() {
    let mut player = Player::of::<Nondimensional>();
    assert_eq!(player.play(&vec![(false, Act::Reset)]), Ok(()));
    player.process.kill().expect("a process of ours");
    let fault = player
        .play(&vec![(false, Act::Reset)])
        .expect_err("no process");
    assert!(fault.contains("signal: 9"), "{fault}");
    assert_eq!(player.play(&vec![(true, Act::Reset)]), Ok(()));
}

/// Scripts of the fuzzer's corpus, which once led somewhere new.
#[test]
fn the_corpus_of_the_fuzzer_is_answered() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/calls");
    let mut player = Player::of::<Nondimensional>();
    let mut count = 0;
    for file in std::fs::read_dir(folder).expect("a folder") {
        let file = file.expect("a file").path();
        let bytes = std::fs::read(&file).expect("readable");
        let script = script::from_fuzzed(&bytes);
        assert_eq!(player.play(&script), Ok(()), "{}", file.display());
        count += usize::from(!script.is_empty());
    }
    assert!(count > 20, "{count} scripts");
}
