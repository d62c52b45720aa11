//! How far the work is, on a terminal only.

use diagnostic::Text;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::inputs::Item;
use crate::message::Messages;

static TEMPLATE: Text = Text::pair(
    "{bar:30} {msg} programs  {decimal_bytes_per_sec}  {elapsed} gone, {eta} left",
    "{bar:30} программ {msg}  {decimal_bytes_per_sec}  прошло {elapsed}, осталось {eta}",
);

/// A bar on standard error: programs, MB/s and the time that is left. Off a terminal, nothing.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    programs: usize,
    done: std::cell::Cell<usize>,
}

impl Progress {
    /// A bar as long as all programs together.
    pub(crate) fn new(items: &[Item], messages: &Messages) -> Self {
        let language = messages.language();
        let target =
            if messages.are_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(items.iter().map(|item| item.bytes).sum()), target);
        bar.set_style(
            ProgressStyle::with_template(TEMPLATE.in_language(language)).expect("a template that was tried"),
        );
        let progress = Self { bar, programs: items.len(), done: std::cell::Cell::new(0) };
        progress.say();
        progress
    }

    /// Nothing is shown.
    pub(crate) fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), programs: 0, done: std::cell::Cell::new(0) }
    }

    /// A program is done.
    pub(crate) fn done(&self, item: &Item) {
        self.bar.inc(item.bytes);
        self.count();
    }

    /// An earlier run had done a program, which is no work and counts for no speed.
    pub(crate) fn was_done(&self, item: &Item) {
        self.bar.dec_length(item.bytes);
        self.count();
    }

    fn count(&self) {
        self.done.set(self.done.get() + 1);
        self.say();
    }

    fn say(&self) {
        if !self.bar.is_hidden() {
            self.bar.set_message(format!("{}/{}", self.done.get(), self.programs));
        }
    }

    /// Says something that stays above the bar.
    pub(crate) fn aside(&self, say: impl FnOnce()) {
        self.bar.suspend(say);
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
