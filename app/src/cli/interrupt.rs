//! Ctrl-C and the signals to end: the first ends a run cleanly, what was computed is written; the second ends the
//! program, as the first does where nothing runs. Files that are not in their places are removed then.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

/// The signal that came, or 0.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
static LISTENING: Once = Once::new();
/// Whether something runs that ends by itself once a signal came.
static ENDS: AtomicBool = AtomicBool::new(false);

/// Lets a run end by itself after the first signal: it asks whether one was [`requested`].
pub(crate) fn listen() {
    ENDS.store(true, Ordering::Relaxed);
    install_once();
}

/// Lets a signal end the program at once, until something [listens](listen).
pub(super) fn guard() {
    if cfg!(unix) {
        install_once();
    }
}

/// Installs the handlers of SIGINT, SIGTERM and SIGHUP; under `nohup`, SIGHUP stays ignored.
fn install_once() {
    LISTENING.call_once(|| {
        // without a handler a signal ends the program at once: not worth failing for
        let _ = install();
    });
}

#[cfg(unix)]
fn install() -> std::io::Result<()> {
    use signal_hook::consts::SIGHUP;
    use signal_hook::iterator::Signals;
    let mut signals = vec![SIGINT, SIGTERM];
    // where it cannot be known whether it is ignored, it does what it did
    if ignored().is_some_and(|ignored| ignored >> (SIGHUP - 1) & 1 == 0) {
        signals.push(SIGHUP);
    }
    let mut signals = Signals::new(signals)?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            if SIGNAL.swap(signal, Ordering::Relaxed) != 0 || !ENDS.load(Ordering::Relaxed) {
                crate::files::remove_unfinished();
                std::process::exit(exit_code().into());
            }
        }
    })?;
    Ok(())
}

#[cfg(not(unix))]
fn install() -> std::io::Result<()> {
    use std::sync::Arc;
    let came = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&came))?;
        signal_hook::flag::register(signal, Arc::clone(&came))?;
    }
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        while !came.load(Ordering::Relaxed) {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        SIGNAL.store(SIGINT, Ordering::Relaxed);
    })?;
    Ok(())
}

/// The signals that were ignored when the program started, a bit each; None where the system does not tell.
#[cfg(unix)]
fn ignored() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

/// Tells whether the run should end.
#[inline]
pub(crate) fn requested() -> bool {
    SIGNAL.load(Ordering::Relaxed) != 0
}

/// The exit code of programs that a signal ended, by convention: 130 for Ctrl-C, 143 for SIGTERM.
pub(crate) fn exit_code() -> u8 {
    let signal = SIGNAL.load(Ordering::Relaxed);
    128 + u8::try_from(if signal == 0 { SIGINT } else { signal }).unwrap_or(0).min(127)
}
