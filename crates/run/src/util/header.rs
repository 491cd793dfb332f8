//! Finds columns by their names, for every reader of a table. Two columns of one name are refused: nothing tells which is
//! meant.

/// What the values of a column are wanted as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// An id or a class: whole numbers keep all their digits.
    Text,
    /// A number; a text that holds one stays a text.
    Number,
}

/// The place of the column with exactly this name; none if there is none.
///
/// # Errors
/// Where several columns have it.
pub fn exact(names: &[String], wanted: &str) -> Result<Option<usize>, String> {
    only(names, wanted, |name| name == wanted)
}

/// The place of the column with this name, or else of that which differs from it only in upper and lower case.
///
/// # Errors
/// Where several columns have it.
pub(crate) fn any_case(names: &[String], wanted: &str) -> Result<Option<usize>, String> {
    match exact(names, wanted)? {
        None => only(names, wanted, |name| name.eq_ignore_ascii_case(wanted)),
        place => Ok(place),
    }
}

fn only(names: &[String], wanted: &str, is_meant: impl Fn(&str) -> bool) -> Result<Option<usize>, String> {
    let mut found = names.iter().enumerate().filter(|(_, name)| is_meant(name)).map(|(place, _)| place);
    match (found.next(), found.count()) {
        (place, 0) => Ok(place),
        (_, more) => Err(format!("it has {} columns {wanted}", more + 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_name_wins_and_two_of_a_name_are_refused() {
        let names = ["X", "x", "t", "Y", "y", "y", "A", "a"].map(str::to_owned);
        assert_eq!(
            [any_case(&names, "x"), any_case(&names, "T"), any_case(&names, "z")],
            [Ok(Some(1)), Ok(Some(2)), Ok(None)]
        );
        assert_eq!(exact(&names, "T"), Ok(None));
        assert_eq!(exact(&names, "y"), Err("it has 2 columns y".to_owned()));
        assert_eq!(any_case(&names[..6], "Y"), Ok(Some(3)));
        assert!(any_case(&["X".to_owned(), "X".to_owned()], "x").is_err());
    }
}
