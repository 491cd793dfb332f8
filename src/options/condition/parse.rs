//! Reads a condition: recursive descent over its text.

use strum::VariantNames;

use super::comparison::{Comparison, Operator};
use super::measure::Measure;
use super::tree::Tree;

/// Parentheses within parentheses; more are refused before the stack ends.
const DEEPEST: usize = 64;

/// What is left of the text.
pub(super) struct Parser<'a> {
    rest: &'a str,
    depth: usize,
}

impl<'a> Parser<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { rest: text.trim(), depth: 0 }
    }

    /// The whole text.
    pub(super) fn tree(mut self) -> Result<Tree, String> {
        let tree = self.either()?;
        if self.rest.is_empty() { Ok(tree) } else { Err(self.expected("\"and\" or \"or\"")) }
    }

    fn either(&mut self) -> Result<Tree, String> {
        self.joined("or", Self::both, Tree::Or)
    }

    fn both(&mut self) -> Result<Tree, String> {
        self.joined("and", Self::part, Tree::And)
    }

    /// One part, or several with this word between.
    fn joined(
        &mut self,
        word: &str,
        part: fn(&mut Self) -> Result<Tree, String>,
        join: fn(Vec<Tree>) -> Tree,
    ) -> Result<Tree, String> {
        let first = part(self)?;
        let mut parts = vec![first];
        while self.word() == word {
            self.skip(word.len());
            parts.push(part(self)?);
        }
        Ok(if parts.len() == 1 { parts.remove(0) } else { join(parts) })
    }

    fn part(&mut self) -> Result<Tree, String> {
        if !self.rest.starts_with('(') {
            return self.comparison();
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("parentheses are nested too deeply".to_owned());
        }
        self.skip(1);
        let inner = self.either()?;
        if !self.rest.starts_with(')') {
            return Err(self.expected("\")\""));
        }
        self.skip(1);
        self.depth -= 1;
        Ok(inner)
    }

    fn comparison(&mut self) -> Result<Tree, String> {
        let name = self.word();
        if name.is_empty() {
            return Err(self.expected("a measure"));
        }
        let measure = name.parse().map_err(|_| unknown(name))?;
        self.skip(name.len());
        let found = Operator::ALL.into_iter().find(|(text, _)| self.rest.starts_with(text));
        let (text, operator) = found.ok_or_else(|| self.expected("<, <=, > or >="))?;
        self.skip(text.len());
        let end = self.rest.find(|letter: char| letter.is_whitespace() || letter == ')').unwrap_or(self.rest.len());
        let number = self.rest[..end].parse::<f64>().ok().filter(|number| number.is_finite());
        let value = number.ok_or_else(|| self.expected("a number"))?;
        self.skip(end);
        Ok(Tree::Compare(Comparison { measure, operator, value }))
    }

    /// The letters that come next.
    fn word(&self) -> &'a str {
        let is_letter = |letter: char| letter.is_ascii_alphabetic() || letter == '_';
        &self.rest[..self.rest.find(|letter| !is_letter(letter)).unwrap_or(self.rest.len())]
    }

    fn skip(&mut self, length: usize) {
        self.rest = self.rest[length..].trim_start();
    }

    fn expected(&self, what: &str) -> String {
        match self.rest {
            "" => format!("expected {what} at the end"),
            rest => format!("expected {what} instead of \"{rest}\""),
        }
    }
}

/// That a measure is unknown, and which one may be meant.
fn unknown(name: &str) -> String {
    let names = Measure::VARIANTS;
    let alike = names.iter().map(|known| (strsim::levenshtein(name, known), *known)).min();
    let is_end = |known: &&str| known.strip_suffix(name).is_some_and(|before| before.ends_with('_'));
    let meant = alike.filter(|(edits, _)| 2 * edits <= name.len()).map(|(_, known)| known);
    let meant = meant.or_else(|| names.iter().copied().find(is_end));
    match meant {
        Some(meant) => format!("unknown measure \"{name}\"; did you mean \"{meant}\"?"),
        None => format!("unknown measure \"{name}\"; known are {}", names.join(", ")),
    }
}
