//! SIGINT and SIGTERM end the work, whatever it is doing.
//!
//! Work asks between blocks ([`Interrupt::check`]) and then ends in order. What cannot ask, since it waits for a pipe or
//! computes on, is ended from outside a little later: files get their names whole or not at all, so nothing half done
//! is left either way.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
#[cfg(not(target_family = "wasm"))]
use std::time::Duration;

use crate::message::Failure;

/// Longer than the time between two checks of any work that checks, shorter than people wait.
#[cfg(not(target_family = "wasm"))]
const GRACE: Duration = Duration::from_millis(400);

/// The first signal that came, 0 before.
#[derive(Debug, Clone)]
pub(crate) struct Interrupt(Arc<AtomicUsize>);

static HEARD: OnceLock<Interrupt> = OnceLock::new();

impl Interrupt {
    /// Hears SIGINT and SIGTERM from the first call on.
    pub(crate) fn listen() -> Self {
        let listen = || {
            let seen = Arc::new(AtomicUsize::new(0));
            hear(&seen);
            Self(seen)
        };
        HEARD.get_or_init(listen).clone()
    }

    /// Fails once a signal has come.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        match self.0.load(Ordering::Relaxed) {
            0 => Ok(()),
            signal => Err(Failure::Interrupted(u8::try_from(signal).unwrap_or(2))),
        }
    }
}

/// Where signals cannot be heard they end the process at once, as they would have without us.
#[cfg(not(target_family = "wasm"))]
fn hear(seen: &Arc<AtomicUsize>) {
    use std::thread::Builder;

    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    /// Ends the process as the shells say it of a signal.
    fn end(signal: usize) {
        std::process::exit(128 + i32::try_from(signal).unwrap_or(SIGINT))
    }

    let heard = Arc::clone(seen);
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    let _ = Builder::new().spawn(move || {
        for signal in signals.forever() {
            let number = usize::from(signal.unsigned_abs() as u16);
            if heard.swap(number, Ordering::Relaxed) != 0 {
                // Asked twice.
                end(number);
            }
            Builder::new()
                .spawn(move || {
                    std::thread::sleep(GRACE);
                    end(number);
                })
                .map_or_else(|_| end(number), drop);
        }
    });
}

/// A page that no longer wants the answer drops the whole machine that computes it.
#[cfg(target_family = "wasm")]
fn hear(_: &Arc<AtomicUsize>) {}
