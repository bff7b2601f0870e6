//! A tokeniser for WGSL, for errors that naga does not report.

/// The identifiers, numbers and single characters of a source with their positions, without comments.
pub(crate) fn tokens(source: &str) -> Vec<(usize, &str)> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = source[at..].chars().next() {
        let rest = &source[at..];
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            comment(rest)
        } else if is_word(c) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        if !c.is_whitespace() && !rest.starts_with("//") && !rest.starts_with("/*") {
            tokens.push((at, &rest[..length]));
        }
        at += length;
    }
    tokens
}

/// The length of a block comment; block comments nest.
fn comment(text: &str) -> usize {
    let (mut at, mut depth) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (at, depth) = (at + 2, depth + 1);
        } else if rest.starts_with("*/") {
            (at, depth) = (at + 2, depth - 1);
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// The names that are declared at module scope, with their positions.
pub(crate) fn declarations(source: &str) -> Vec<(usize, &str)> {
    let mut names = Vec::new();
    let mut depth = 0;
    let mut tokens = tokens(source).into_iter();
    while let Some((_, token)) = tokens.next() {
        match token {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            "fn" | "struct" | "alias" | "const" | "override" if depth == 0 => names.extend(tokens.next()),
            // var<storage, read> name
            "var" if depth == 0 => match tokens.next() {
                Some((_, "<")) => {
                    tokens.by_ref().find(|t| t.1 == ">");
                    names.extend(tokens.next());
                }
                name => names.extend(name),
            },
            _ => {}
        }
    }
    names
}

/// The position of the first bracket that is not closed.
pub(crate) fn unclosed(source: &str) -> Option<usize> {
    let mut open = Vec::new();
    for (at, token) in tokens(source) {
        match token {
            "{" | "(" | "[" => open.push(at),
            "}" | ")" | "]" => drop(open.pop()),
            _ => {}
        }
    }
    open.first().copied()
}
