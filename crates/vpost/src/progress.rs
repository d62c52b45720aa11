//! How far one long job is: a bar on a terminal, `FILTER_PROGRESS` lines where they are asked for, else nothing.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use diagnostic::{Language, Text};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::arguments;
use crate::message::Messages;

/// Work that ends sooner needs no bar: it would only flash.
const SOON: Duration = Duration::from_millis(500);
/// A bar of so many parts.
const PARTS: u64 = 1000;

/// The share of a job that is done.
pub(crate) struct Progress<'a> {
    messages: &'a Messages,
    style: Option<arguments::Progress>,
    begun: Instant,
    shown: Mutex<Shown>,
}

#[derive(Default)]
struct Shown {
    percent: Option<u64>,
    bar: Option<ProgressBar>,
}

impl<'a> Progress<'a> {
    /// A job that begins now; without a style a bar, which draws nothing where standard error is no terminal.
    pub(crate) fn new(messages: &'a Messages, style: Option<arguments::Progress>) -> Self {
        Self { messages, style, begun: Instant::now(), shown: Mutex::default() }
    }

    /// The share that is done, 0 to 1, from any thread.
    pub(crate) fn report(&self, done: f64) {
        let mut shown = self.shown.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let percent = (done * 100.0) as u64;
        match self.style {
            Some(arguments::Progress::Linuxcnc) if shown.percent != Some(percent) => {
                self.messages.note(&Text::same(format!("FILTER_PROGRESS={percent}")));
                shown.percent = Some(percent);
            }
            Some(arguments::Progress::Linuxcnc) => {}
            None if self.messages.are_quiet() || self.begun.elapsed() < SOON => {}
            None => shown
                .bar
                .get_or_insert_with(|| bar(self.messages.language()))
                .set_position((done * PARTS as f64) as u64),
        }
    }

    /// Takes the bar away: what follows stands where it was.
    pub(crate) fn end(&self) {
        if let Some(bar) = self.shown.lock().unwrap_or_else(std::sync::PoisonError::into_inner).bar.take() {
            bar.finish_and_clear();
        }
    }
}

static TEMPLATE: Text = Text::pair(
    "{bar:30} {percent} %  {elapsed} gone, {eta} left",
    "{bar:30} {percent} %  прошло {elapsed}, осталось {eta}",
);

/// Its parts say how much, the clock how long.
fn bar(language: Language) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
    let template = TEMPLATE.in_language(language);
    bar.set_style(ProgressStyle::with_template(template).expect("a template that was tried"));
    bar
}

/// A failure's message must not stand behind half a bar.
impl Drop for Progress<'_> {
    fn drop(&mut self) {
        self.end();
    }
}
