//! The program on a terminal and in shells: colours and folded lines there, plain lines in a pipe, words completed.
//!
//! `script` makes the terminal. It and the shells are used where they are installed.

#![allow(missing_docs)]
#![cfg(target_os = "linux")]

mod program;

use std::{
    fs,
    io::{Read, Write},
    process::{Command, Stdio},
};

use program::{folder, packlight, path, stderr, stdout};

const PROGRAM: &str = env!("CARGO_BIN_EXE_packlight");

/// Columns of the terminal.
const COLUMNS: usize = 80;

/// And of one that shares a screen.
const NARROW: usize = 60;

/// What somebody sees who types the words at a terminal, or `None` if there is no `script`.
fn on_a_terminal(words: &str, no_color: &str) -> Option<String> {
    on_columns(COLUMNS, words, no_color)
}

/// The same, of so many columns.
fn on_columns(columns: usize, words: &str, no_color: &str) -> Option<String> {
    let line = format!("stty rows 50 cols {columns}; {PROGRAM} {words}");
    let mut command = Command::new("script");
    command.args(["-qec", &line, "/dev/null"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    let Ok(output) = command.env("NO_COLOR", no_color).output() else {
        println!("skipped: there is no `script`");
        return None;
    };
    Some(stdout(&output).replace('\r', ""))
}

/// What a terminal of 80 columns has on its screen after all that was sent to it: of what a bar and its end need, no more.
fn screen(sent: &str) -> Vec<String> {
    let (mut lines, mut row, mut column) = (vec![Vec::new()], 0, 0);
    let mut rest = sent.chars();
    while let Some(c) = rest.next() {
        match c {
            '\r' => column = 0,
            '\n' => row += 1,
            '\x1b' => {
                let order: String = rest.by_ref().skip(1).take_while(|c| !c.is_ascii_alphabetic()).collect();
                if order == "2" {
                    lines[row] = Vec::new();
                }
            }
            _ => {
                if column == COLUMNS {
                    (row, column) = (row + 1, 0);
                }
                lines.resize(lines.len().max(row + 1), Vec::new());
                let length = lines[row].len().max(column + 1);
                lines[row].resize(length, ' ');
                lines[row][column] = c;
                column += 1;
            }
        }
        lines.resize(lines.len().max(row + 1), Vec::new());
    }
    lines.into_iter().map(String::from_iter).collect()
}

#[test]
fn no_bar_is_left_of_a_render_that_was_stopped() {
    let picture = path(&folder("terminal/stopped"), "a.exr");
    let line =
        format!("stty rows 50 cols {COLUMNS}; {PROGRAM} render scenes/cornell.xml --spp 100000 -o {picture}");
    let mut command = Command::new("script");
    command.args(["-qec", &line, "/dev/null"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let Ok(mut child) = command.spawn() else { return println!("skipped: there is no `script`") };
    let mut out = child.stdout.take().expect("a pipe");
    let (mut sent, mut bytes, mut bars) = (Vec::new(), [0; 1024], 0);
    while let Ok(count @ 1..) = out.read(&mut bytes) {
        sent.extend(&bytes[..count]);
        bars +=
            usize::from(sent.ends_with(b"left") || String::from_utf8_lossy(&bytes[..count]).contains("left"));
        if bars == 3 {
            // What is pressed is Ctrl-C, once.
            bars += 1;
            child.stdin.as_mut().expect("a pipe").write_all(b"\x03").expect("it listens");
        }
    }
    child.wait().expect("it ends");
    let sent = String::from_utf8_lossy(&sent);
    assert!(sent.contains("^C") && sent.contains("stopped: "), "{sent}");
    let screen = screen(&sent);
    assert!(screen.iter().all(|line| !line.contains("rendering [")), "{screen:#?}");
}

/// A scene with a slip.
fn wrong(name: &str) -> String {
    let scene = path(&folder(name), "wrong.xml");
    fs::write(&scene, "<scene version='3.0.0'><shap/></scene>").expect("writable");
    scene
}

#[test]
fn colours_are_for_terminals_that_want_them() {
    let scene = wrong("terminal/colours");
    let told = stderr(&packlight(&["info", &scene]));
    assert!(told.contains("did you mean `shape`?") && !told.contains('\x1b'), "{told}");
    for words in [format!("info {scene}"), "render no-such.xml -o a.exr".into(), "rendr".into()] {
        let Some(coloured) = on_a_terminal(&words, "") else { return };
        assert!(coloured.contains("\x1b[31m") || coloured.contains("\x1b[1m"), "{coloured}");
        let plain = on_a_terminal(&words, "1").expect("it was there");
        assert!(plain.contains("error:") && !plain.contains('\x1b'), "{plain}");
    }
}

#[test]
fn nothing_is_wider_than_the_terminal() {
    let out = path(&folder("terminal/wide"), "a.exr");
    let render = format!("render scenes/cornell.xml -o {out} --width 32 --spp 1 --stats");
    for words in [
        "info scenes/materials.xml",
        "bench scenes/cornell.xml --repeat 1",
        "verify scenes/cornell.xml --most 512",
        "render --help",
        "bench --help",
        "--help",
        &render,
    ] {
        let Some(told) = on_a_terminal(words, "1") else { return };
        // But for the names of files.
        let wide: Vec<&str> =
            told.lines().filter(|line| line.chars().count() > COLUMNS && !line.contains(&out)).collect();
        assert!(wide.is_empty() && told.lines().count() > 5, "{words}: {wide:#?}\n{told}");
    }
    // In a pipe a line stays a line.
    let told = stdout(&packlight(&["info", "scenes/materials.xml"]));
    assert!(told.lines().any(|line| line.contains("materials") && line.contains("ward")), "{told}");
}

#[test]
fn what_is_told_on_a_narrow_terminal_is_broken_between_words() {
    let folder = folder("terminal/narrow");
    let out = path(&folder, "a.exr");
    let render = format!("render scenes/cornell.xml -o {out} --width 32 --spp 1 --stats");
    for words in [
        &render,
        "info scenes/materials.xml",
        "bench scenes/cornell.xml --repeat 1",
        "verify scenes/cornell.xml --most 512",
        "brdf diffuse --check",
        "meter scenes/cornell.xml --at 0,0,0 --normal 0,1,0",
    ] {
        let Some(told) = on_columns(NARROW, words, "1") else { return };
        // What stands before was taken off the screen again; and but for the names of files.
        let seen = told.lines().map(|line| line.rsplit("\x1b[2K").next().unwrap_or_default());
        let wide: Vec<&str> =
            seen.filter(|line| line.chars().count() > NARROW && !line.contains(&out)).collect();
        assert!(wide.is_empty() && told.lines().count() > 4, "{words}: {wide:#?}\n{told}");
    }
    // A table that has no room is another table, not one whose lines go on below.
    let told = on_columns(NARROW, "bench scenes/cornell.xml --repeat 1", "1").expect("it was there");
    assert_eq!(told.lines().filter(|line| line.starts_with("    single rays ")).count(), 5, "{told}");
    let words = "verify scenes/cornell.xml --most 512";
    let piped = stdout(&packlight(&words.split(' ').collect::<Vec<_>>()));
    let told = on_columns(NARROW / 2, words, "1").expect("it was there");
    assert!(told.lines().count() > piped.lines().count(), "{told}");
    assert_eq!(told.split_whitespace().collect::<Vec<_>>(), piped.split_whitespace().collect::<Vec<_>>());
}

#[test]
fn a_long_line_of_a_file_is_shown_where_it_is_meant() {
    let scene = path(&folder("terminal/long"), "a.xml");
    let line =
        "<bsdf type=\"diffuse\" id=\"white\"><rgb name=\"reflectence\" value=\"0.73, 0.71, 0.68\"/></bsdf>";
    fs::write(
        &scene,
        format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\n    {line}\n</scene>\n"),
    )
    .expect("writable");
    let Some(told) = on_columns(NARROW, &format!("info {scene}"), "1") else { return };
    let shown: Vec<&str> = told.lines().filter(|line| !line.contains("a.xml")).collect();
    assert!(shown.iter().all(|line| line.chars().count() <= NARROW), "{told}");
    let at = shown.iter().position(|line| line.contains("reflectence\"")).expect("it is shown");
    let column = |line: &str, part: &str| line.find(part).map(|byte| line[..byte].chars().count());
    assert_eq!(column(shown[at], "reflectence"), column(shown[at + 1], "─────┬─────"), "{told}");
    assert!(told.contains("a.xml:2:48]") && shown[at].contains('…'), "{told}");
    // In a pipe a line is whole.
    assert!(stderr(&packlight(&["info", &scene])).contains(line));
}

#[test]
fn sentences_are_broken_between_words() {
    let out = path(&folder("terminal/sentences"), "a.exr");
    let words = "render scenes/cornell.xml --width 8 --spp 1 --quiet --display-server localhost:1 -o";
    let Some(told) = on_a_terminal(&format!("{words} {out}"), "") else { return };
    assert!(told.starts_with("\x1b[33mwarning:\x1b[0m no display server at localhost:1 ("), "{told}");
    let lines: Vec<&str> = told.lines().collect();
    let (first, rest) = lines.split_first().expect("there is a warning");
    assert!(first.chars().count() <= COLUMNS + 9 && rest.iter().all(|line| line.starts_with("  ")), "{told}");
    let joined = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(joined.ends_with("; the render goes on without it"), "{told}");
}

#[test]
fn what_is_wrong_with_a_command_line_is_broken_between_words() {
    let words = "render a.xml -o a.exr --checkpoint b.exr --resume c.exr --shard 1/2 --pixel 3,4";
    let Some(told) = on_a_terminal(words, "1") else { return };
    assert!(told.lines().all(|line| line.chars().count() <= COLUMNS), "{told}");
    let piped = stderr(&packlight(&words.split(' ').collect::<Vec<_>>()));
    let usage = piped.lines().find(|line| line.starts_with("Usage:")).expect("it says how");
    assert!(usage.chars().count() > COLUMNS, "{usage}");
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    assert_eq!(words(&told), words(&piped));
    let coloured = on_a_terminal("render --no-such-flag", "").expect("it was there");
    assert!(coloured.contains("\x1b[1m") && coloured.contains("--no-such-flag"), "{coloured}");
}

/// What a shell prints, or `None` if it is not there.
fn shell(name: &str, script: &str) -> Option<String> {
    let folder = std::path::Path::new(PROGRAM).parent().expect("it is in a folder").display().to_string();
    let path = format!("{folder}:{}", std::env::var("PATH").unwrap_or_default());
    let Ok(output) = Command::new(name).args(["-c", script]).env("PATH", path).output() else {
        println!("skipped: there is no `{name}`");
        return None;
    };
    Some(stdout(&output) + &stderr(&output))
}

#[test]
fn bash_and_fish_complete_commands_options_and_values() {
    let bash = |words: &str, word: &str, before: &str| {
        let count = words.split(' ').count();
        shell(
            "bash",
            &format!(
                "source <(packlight completions bash); COMP_WORDS=({words} '{word}'); COMP_CWORD={count}; \
                 _packlight packlight '{word}' {before}; echo \"${{COMPREPLY[@]}}\""
            ),
        )
    };
    let fish = |line: &str| {
        shell("fish", &format!("packlight completions fish | source; complete -C '{line}' | cut -f1 | xargs"))
    };
    for (words, word, before, expected) in [
        ("packlight", "re", "packlight", "render\n"),
        ("packlight", "comp", "packlight", "compare completions\n"),
        ("packlight render", "--ton", "render", "--tonemap\n"),
        ("packlight render --exr-compression", "zi", "--exr-compression", "zips zip\n"),
        ("packlight brdf sheet", "--sp", "sheet", "--spp\n"),
    ] {
        let sorted = |told: &str| {
            let mut words: Vec<String> = told.split_whitespace().map(String::from).collect();
            words.sort();
            words
        };
        if let Some(told) = bash(words, word, before) {
            assert_eq!(sorted(&told), sorted(expected), "{words} {word}: {told}");
        }
        if let Some(told) = fish(&format!("{words} {word}")) {
            assert_eq!(sorted(&told), sorted(expected), "{words} {word}: {told}");
        }
    }
}

/// What a line has become for somebody who types it at zsh's prompt and presses the tabulator, or `None` if there is
/// no zsh. The key ^X tells it.
fn completed_by_zsh(line: &str) -> Option<String> {
    let script = r#"zmodload zsh/zpty; zpty inner zsh -f -i
        zpty -w inner 'TMOUT=300 PS1= RPS1=; autoload -U compinit; compinit -D -u; eval "$(packlight completions zsh)"'
        zpty -w inner 'told() { print -r -- "<${BUFFER}>"; exit }; zle -N told; bindkey "^X" told; bindkey "^I" complete-word'
        zpty -w -n inner 'LINE'$'\t\C-X'
        zpty -r inner"#;
    let told = shell("zsh", &script.replace("LINE", line))?;
    let (_, last) = told.rsplit_once('<').unwrap_or_else(|| panic!("{line}: {told}"));
    Some(last.split('>').next().unwrap_or_default().to_owned())
}

#[test]
fn zsh_completes_at_its_prompt() {
    for (line, expected) in [
        ("packlight re", "packlight render "),
        ("packlight render --ton", "packlight render --tonemap="),
        ("packlight render --exr-compression pi", "packlight render --exr-compression piz "),
        ("packlight brdf sheet --sp", "packlight brdf sheet --spp="),
        // There are two, which are shown.
        ("packlight com", "packlight comp"),
        ("packlight nothing-like-it", "packlight nothing-like-it"),
    ] {
        let Some(completed) = completed_by_zsh(line) else { return };
        assert_eq!(completed, expected, "{line}");
    }
}
