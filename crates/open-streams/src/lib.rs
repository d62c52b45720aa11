//! Which standard streams were open at start.
//!
//! Rust's runtime opens `/dev/null` in the place of a standard stream that is closed, before `main` begins: what is
//! printed then goes nowhere and counts as printed. A command whose result is what it prints must know. So this looks
//! before the runtime does, in a function of the program's initialisation (ELF `.init_array`).
//!
//! Linux only; elsewhere the answer is yes, and a closed stream is not noticed.

/// True where standard output was open when the process began.
#[must_use]
pub fn is_stdout_open() -> bool {
    at_start::is_stdout_open()
}

#[cfg(target_os = "linux")]
mod at_start {
    use std::sync::atomic::{AtomicBool, Ordering};

    static STDOUT_CLOSED: AtomicBool = AtomicBool::new(false);

    // SAFETY: the linker's section of functions that the C runtime calls before `main`, each with the signature of
    // `look` or a longer one, whose arguments a C function may leave unread.
    #[used]
    #[unsafe(link_section = ".init_array")]
    static LOOK: extern "C" fn() = look;

    extern "C" fn look() {
        // SAFETY: asks for the flags of a descriptor's number, open or not; touches no memory. Nothing of Rust's
        // runtime is needed, which has not begun.
        let flags = unsafe { libc::fcntl(libc::STDOUT_FILENO, libc::F_GETFD) };
        STDOUT_CLOSED.store(flags == -1, Ordering::Relaxed);
    }

    pub(super) fn is_stdout_open() -> bool {
        !STDOUT_CLOSED.load(Ordering::Relaxed)
    }
}

#[cfg(not(target_os = "linux"))]
mod at_start {
    pub(super) fn is_stdout_open() -> bool {
        true
    }
}
