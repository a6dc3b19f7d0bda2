//! Problems of a description, shown in its text.

use std::fmt;

use proc_macro2::Span;

/// A description that no system can be made of: all its problems.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DescriptionError {
    file: String,
    problems: Vec<Problem>,
}

/// A problem of a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// What is wrong.
    pub message: String,
    /// Where it is, if it is anywhere in particular.
    pub place: Option<Place>,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1 on.
    pub line: usize,
    /// The column, from 1 on, in characters.
    pub column: usize,
    /// How many characters of the line it is about.
    pub width: usize,
    /// The line's text.
    pub text: String,
}

/// Of a line that is longer, so many characters are shown on each side of what is wrong.
const AROUND: usize = 60;

impl DescriptionError {
    /// The name of the text.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The problems, in the order in which they stand in the text.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    pub(crate) fn new(file: &str, problems: Vec<Problem>) -> Self {
        Self { file: file.to_owned(), problems }
    }

    pub(crate) fn of(file: &str, text: &str, error: syn::Error) -> Self {
        let problems = error.into_iter().map(|error| Problem::at(text, error.span(), error.to_string()));
        let mut problems: Vec<Problem> = problems.collect();
        problems.sort_by_key(|problem| problem.place.as_ref().map(|place| (place.line, place.column)));
        problems.dedup();
        Self::new(file, problems)
    }
}

impl Problem {
    pub(crate) fn without_place(message: &str) -> Self {
        Self { message: message.to_owned(), place: None }
    }

    pub(crate) fn at(text: &str, span: Span, message: String) -> Self {
        let (start, end) = (span.start(), span.end());
        // a span of nothing is that of the whole
        let is_nowhere = span.byte_range().is_empty() && start.line <= 1 && start.column == 0;
        let line = text.split('\n').nth(start.line.saturating_sub(1)).filter(|_| !is_nowhere);
        let place = line.map(|line| {
            let line = line.trim_end_matches('\r');
            let length = line.chars().count();
            let until = if end.line == start.line { end.column } else { length };
            Place {
                line: start.line,
                column: start.column + 1,
                width: until.saturating_sub(start.column).max(1),
                text: line.to_owned(),
            }
        });
        Self { message, place }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, kind: &str, file: &str) -> fmt::Result {
        write!(f, "{kind}: {}", self.message)?;
        let Some(Place { line, column, width, text }) = &self.place else {
            return write!(f, "\n --> {file}");
        };
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        // no terminal shows a line of thousands
        let from = if text.chars().count() > 3 * AROUND { (column - 1).saturating_sub(AROUND) } else { 0 };
        let shown: String =
            text.chars().skip(from).take(3 * AROUND).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let indent = " ".repeat(column - 1 - from);
        let room = (3 * AROUND).saturating_sub(column - 1 - from).max(1);
        let carets = "^".repeat((*width).min(room));
        write!(
            f,
            "\n{margin}--> {file}:{line}:{column}\n{margin} |\n{number} | {shown}\n{margin} | {indent}{carets}"
        )
    }
}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, problem) in self.problems.iter().enumerate() {
            if place > 0 {
                f.write_str("\n\n")?;
            }
            problem.write(f, "error", &self.file)?;
        }
        Ok(())
    }
}

impl std::error::Error for DescriptionError {}

/// A warning, to be shown.
pub(crate) struct Warned<'a>(pub(crate) &'a Problem, pub(crate) &'a str);

impl fmt::Display for Warned<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.write(f, "warning", self.1)
    }
}
