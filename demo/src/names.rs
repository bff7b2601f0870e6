//! The nearest names to one that is not known, for messages.

/// Of the choices, the one that `name` most likely meant; the first of equals. `None` if none is near.
///
/// Near is a Damerau-Levenshtein distance, letter case aside, of at most a third of the longer name: a slip of the
/// keyboard in a short name, two or three in a long one.
pub fn nearest<'a>(name: &str, choices: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    let distance = |choice: &str| strsim::damerau_levenshtein(&name, &choice.to_lowercase());
    let near = |choice: &str| distance(choice) * 3 <= name.chars().count().max(choice.chars().count());
    choices.iter().copied().filter(|c| near(c)).min_by_key(|c| distance(c))
}

/// [`nearest`] as part of a message, " did you mean windowed?"; empty if none is near.
pub fn did_you_mean(name: &str, choices: &[&str]) -> String {
    nearest(name, choices).map_or(String::new(), |choice| format!(" did you mean {choice}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TECHNIQUES: [&str; 3] = ["full", "single", "windowed"];

    #[test]
    fn slips_are_near() {
        // One letter left out, two swapped, one wrong, one too many, another case, half a word left out.
        for (slip, meant) in [
            ("windwed", "windowed"),
            ("sinlge", "single"),
            ("gull", "full"),
            ("fulll", "full"),
            ("FULL", "full"),
            ("window", "windowed"),
        ] {
            assert_eq!(nearest(slip, &TECHNIQUES), Some(meant), "{slip}");
        }
    }

    #[test]
    fn other_words_are_not() {
        for word in ["", "magic", "f", "oval", "reconstructed"] {
            assert_eq!(nearest(word, &TECHNIQUES), None, "{word}");
        }
        assert_eq!(nearest("full", &[]), None);
    }

    #[test]
    fn the_nearest_wins_and_the_first_of_equals() {
        assert_eq!(nearest("depths", &["depth_x", "depth"]), Some("depth"));
        assert_eq!(nearest("caat", &["coat", "cart"]), Some("coat"));
    }
}
