//! As much of Rust's grammar as it takes to see which paths a file names.

/// The text with comments, strings and characters blanked out; line breaks stay.
pub(crate) fn without_comments(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = blank_length(rest, code.chars().next_back());
        if length == 0 {
            code.push(first);
            rest = &rest[first.len_utf8()..];
        } else {
            code.extend(rest[..length].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
            rest = &rest[length..];
        }
    }
    code
}

/// Bytes of the comment or literal at the start of `text`; 0 if there is none.
fn blank_length(text: &str, before: Option<char>) -> usize {
    if text.starts_with("//") {
        return text.find('\n').unwrap_or(text.len());
    }
    if text.starts_with("/*") {
        return block_comment(text);
    }
    if text.starts_with('"') {
        return quoted(text, '"');
    }
    if text.starts_with('r') && !before.is_some_and(is_name) {
        return raw_string(text);
    }
    if let Some(inside) = text.strip_prefix('\'') {
        // 'a is a lifetime, 'a' and '\n' are characters.
        let mut inside = inside.chars();
        let character = inside.next() == Some('\\') || inside.next() == Some('\'');
        return if character { quoted(text, '\'') } else { 0 };
    }
    0
}

fn block_comment(text: &str) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            depth += 1;
            at += 2;
        } else if rest.starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Through the closing quote, past escaped ones.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return at + 1,
            _ => {}
        }
    }
    text.len()
}

fn raw_string(text: &str) -> usize {
    let hashes = text[1..].len() - text[1..].trim_start_matches('#').len();
    if !text[1 + hashes..].starts_with('"') {
        return 0;
    }
    let end = format!("\"{}", "#".repeat(hashes));
    let body = 2 + hashes;
    text[body..].find(&end).map_or(text.len(), |at| body + at + end.len())
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Names, `::`, and every other character that is not a space.
fn tokens(code: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if is_name(first) {
            rest.find(|c| !is_name(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        found.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    found
}

/// The first name of each path below the crate's root, from `crate::…` and from as many `super::` as
/// lead there.
pub(crate) fn imports(path: &str, code: &str) -> Vec<String> {
    let tokens = tokens(code);
    let mut found = Vec::new();
    let mut modules = ModuleDepth::of(path);
    let mut at = 0;
    while at < tokens.len() {
        modules.step(&tokens, at);
        let leads_on = |at: usize| tokens.get(at + 1) == Some(&"::");
        match tokens[at] {
            "crate" if leads_on(at) => heads(&tokens[at + 2..], &mut found),
            "super" if leads_on(at) => {
                let mut steps = 1;
                while tokens.get(at + 2) == Some(&"super") && leads_on(at + 2) {
                    steps += 1;
                    at += 2;
                }
                if steps == modules.depth() {
                    heads(&tokens[at + 2..], &mut found);
                }
            }
            _ => {}
        }
        at += 1;
    }
    found
}

/// How many modules deep the text is: the file's own, and the `mod name { … }` it stands in.
struct ModuleDepth {
    file: usize,
    braces: usize,
    inline: Vec<usize>,
}

impl ModuleDepth {
    fn of(path: &str) -> Self {
        let file = path.trim_end_matches(".rs").trim_end_matches("/mod").split('/').count();
        Self { file, braces: 0, inline: Vec::new() }
    }

    fn step(&mut self, tokens: &[&str], at: usize) {
        match tokens[at] {
            "{" => {
                self.braces += 1;
                if at >= 2 && tokens[at - 2] == "mod" {
                    self.inline.push(self.braces);
                }
            }
            "}" => {
                self.inline.pop_if(|opened| *opened == self.braces);
                self.braces = self.braces.saturating_sub(1);
            }
            _ => {}
        }
    }

    fn depth(&self) -> usize {
        self.file + self.inline.len()
    }
}

/// The first names after a `::`: one, or those of a group in braces.
fn heads(tokens: &[&str], found: &mut Vec<String>) {
    if tokens.first() != Some(&"{") {
        found.extend(tokens.first().map(|head| (*head).to_owned()));
        return;
    }
    let mut depth = 0;
    let mut expected = false;
    for token in tokens {
        match *token {
            "{" => {
                depth += 1;
                expected = depth == 1;
            }
            "}" => depth -= 1,
            "," => expected = depth == 1,
            head if expected => {
                found.push(head.to_owned());
                expected = false;
            }
            _ => {}
        }
        if depth == 0 {
            return;
        }
    }
}

/// Whether the file names an outside crate: at the start of a path, or in a `use`. A module of that
/// name declared in the file is meant instead.
pub(crate) fn crates(code: &str, name: &str) -> bool {
    let tokens = tokens(code);
    let is = |at: Option<usize>, token: &str| at.and_then(|at| tokens.get(at)) == Some(&token);
    let mut named = false;
    for (at, token) in tokens.iter().enumerate() {
        if *token != name {
            continue;
        }
        let before = at.checked_sub(1);
        if is(before, "mod") {
            return false;
        }
        let rooted = is(before, "::") && !at.checked_sub(2).is_some_and(|at| continues(tokens[at]));
        let starts = !is(before, "::") && !is(before, ".") && is(Some(at + 1), "::");
        let used = is(before, "use") || is(before, "crate") && is(at.checked_sub(2), "extern");
        named |= starts || used || rooted;
    }
    named
}

/// Whether a `::` after this token is in the middle of a path: `a::`, `Vec<u8>::`, but not `use ::`.
fn continues(token: &str) -> bool {
    token == ">" || token.ends_with(is_name) && token != "use"
}

/// Whether a word stands in the code by itself.
pub(crate) fn names_word(code: &str, word: &str) -> bool {
    tokens(code).contains(&word)
}
