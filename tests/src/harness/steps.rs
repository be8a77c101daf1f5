//! Progress on the terminal: one line for each step, with its duration.

use std::{
    fmt::Display,
    future::Future,
    io::Write as _,
    time::{Duration, Instant},
};

/// Runs steps and reports each on standard output.
#[derive(Debug, Default)]
pub struct Steps {
    done: Vec<(String, Duration)>,
}

impl Steps {
    /// Runs a step; its line is printed when it ends, with what it found out.
    ///
    /// # Errors
    /// The step's own, after its line has been marked as failed.
    pub async fn run<T: Display>(
        &mut self,
        title: &str,
        step: impl Future<Output = anyhow::Result<T>>,
    ) -> anyhow::Result<()> {
        let start = Instant::now();
        let outcome = step.await;
        let took = start.elapsed();
        match outcome {
            Ok(found) => {
                let found = found.to_string();
                let separator = if found.is_empty() { "" } else { ": " };
                say(&format!("  ok   {:>7.2} s  {title}{separator}{found}", took.as_secs_f64()));
                self.done.push((title.to_owned(), took));
                Ok(())
            }
            Err(error) => {
                say(&format!("  FAIL {:>7.2} s  {title}: {error:#}", took.as_secs_f64()));
                Err(error.context(title.to_owned()))
            }
        }
    }

    /// Number of steps that held so far, and the time they took together.
    #[must_use]
    pub fn total(&self) -> (usize, Duration) {
        (self.done.len(), self.done.iter().map(|(_, took)| *took).sum())
    }
}

/// Prints a line at once, also into a pipe.
#[allow(clippy::print_stdout)]
pub fn say(line: &str) {
    println!("{line}");
    std::io::stdout().flush().ok();
}
