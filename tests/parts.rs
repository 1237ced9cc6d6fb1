//! Checkpoints, shards and renders that were stopped, as a shell sees them: whatever is cut, killed,
//! resumed and merged ends in the bytes of what was never interrupted.

#![allow(missing_docs)]

mod program;

use std::{
    fs,
    path::Path,
    process::{Child, Command},
    thread,
    time::{Duration, Instant},
};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    render::{Frame, Plan, part::Part},
};
use program::{command, folder, packlight, path, stderr, stdout};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.xml");

/// Not a multiple of a block, several tiles, some of them partly empty.
const PICTURE: [&str; 6] = ["--width", "70", "--spp", "40", "--threads", "2"];

fn succeeds(arguments: &[&str]) {
    let output = packlight(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
}

/// Exit code 1, and a part of the message.
fn fails(arguments: &[&str], code: i32, part: &str) {
    let output = packlight(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
    // Long messages are wrapped.
    let message = stderr(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(message.contains(part), "{arguments:?}: {part} is not in\n{message}");
}

fn render<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", SCENE, "-o", out, "--quiet"], &PICTURE[..], more].concat()
}

fn bytes(path: &str) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("readable");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn same(one: &str, other: &str) {
    assert!(bytes(one) == bytes(other), "{one} and {other} are not the same bytes");
}

/// Waits until a file is there, and the child has not ended before.
fn wait_for(file: &str, child: &mut Child) {
    let start = Instant::now();
    while !Path::new(file).exists() {
        let ended = child.try_wait().expect("a child can be asked").is_some();
        assert!(!ended || Path::new(file).exists(), "it ended before {file} was there");
        assert!(start.elapsed() < Duration::from_secs(120), "{file} does not come");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn shards_merge_to_the_bytes_of_one_machine() {
    let folder = folder("parts/shards");
    let whole = path(&folder, "whole.exr");
    let layers = ["--aov", "albedo,depth"];
    succeeds(&render(&whole, &layers));
    for (by, count) in [("tiles", 4), ("samples", 3), ("samples", 2)] {
        let shards: Vec<String> =
            (1..=count).map(|i| path(&folder, &format!("{by}-{i}-{count}.exr"))).collect();
        for (i, shard) in shards.iter().enumerate() {
            let which = format!("{}/{count}", i + 1);
            succeeds(&render(shard, &[&layers[..], &["--shard", &which, "--shard-by", by]].concat()));
        }
        let merged = path(&folder, "merged.exr");
        // In any order.
        let parts: Vec<&str> = shards.iter().rev().map(String::as_str).collect();
        succeeds(&[&["merge", "-o", &merged, "--quiet"], &parts[..]].concat());
        same(&merged, &whole);
    }
}

#[test]
fn shards_that_do_not_fit_are_named() {
    let folder = folder("parts/unfit");
    let file = |name: &str| path(&folder, name);
    let (one, two, twin, other) = (file("1.exr"), file("2.exr"), file("twin.exr"), file("other.exr"));
    let picture = ["--width", "33", "--spp", "1"];
    let shard = |out: &str, which: &str, more: &[&str]| {
        succeeds(&[&["render", SCENE, "-o", out, "--quiet", "--shard", which], &picture[..], more].concat());
    };
    shard(&one, "1/2", &[]);
    shard(&two, "2/2", &[]);
    shard(&twin, "2/2", &[]);
    shard(&other, "2/2", &["--seed", "9"]);
    let out = file("out.exr");
    let merge = |parts: &[&str]| -> Vec<String> {
        [&["merge", "-o", &out], parts].concat().into_iter().map(String::from).collect()
    };
    let refused = |parts: &[&str], message: &str| {
        let arguments = merge(parts);
        fails(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), 1, message);
        assert!(!Path::new(&out).exists());
    };
    refused(&[&one], "shard 2 of 2 is not there");
    refused(&[&one, &two, &twin], "are both shard 2/2");
    refused(&[&one, &other], "the seed is 9 there and 0 here");
    fs::write(file("picture.exr"), b"v/1\x01").expect("writable");
    refused(&[&one, &file("picture.exr")], "no checkpoint and no shard");
    succeeds(&["merge", &one, "-o", &out, "--partial"]);
    assert!(Path::new(&out).exists());
}

#[test]
fn shards_are_numbered_by_the_environment() {
    let folder = folder("parts/environment");
    let (typed, asked) = (path(&folder, "typed.exr"), path(&folder, "asked.exr"));
    let picture = ["--width", "33", "--spp", "1", "--quiet"];
    succeeds(&[&["render", SCENE, "-o", &typed, "--shard", "2/2"], &picture[..]].concat());
    let from =
        [&["render", SCENE, "-o", &asked, "--shard-from", "PART", "--shards", "2"], &picture[..]].concat();
    let with = |value: &str| command(&from).env("PART", value).output().expect("the program starts");
    assert_eq!(with("1").status.code(), Some(0), "{}", stderr(&with("1")));
    // Times differ, sums do not.
    let out = path(&folder, "out.exr");
    succeeds(&["merge", &typed, "-o", &out, "--partial", "--quiet"]);
    let first = bytes(&out);
    succeeds(&["merge", &asked, "-o", &out, "--partial", "--quiet"]);
    assert!(first == bytes(&out));
    assert!(stderr(&with("2")).contains("from 0 to 1"), "{}", stderr(&with("2")));
    fails(&from, 1, "no variable PART");
    fails(&render(&out, &["--shard", "3/2"]), 2, "--shard 3/16");
    fails(&render(&out, &["--shard", "1/9", "--shard-by", "samples"]), 2, "there are 3 for 9");
    let png = path(&folder, "a.png");
    fails(&render(&png, &["--shard", "1/2"]), 2, "only into an .exr");
}

#[test]
fn a_killed_render_is_resumed_to_the_bit() {
    let folder = folder("parts/killed");
    let (whole, out, kept) =
        (path(&folder, "whole.exr"), path(&folder, "out.exr"), path(&folder, "kept.exr"));
    succeeds(&render(&whole, &[]));
    let keep = ["--checkpoint", &kept, "--every", "1ms"];
    let mut kills = 0;
    // As a queue would: the same command again and again, until it ends by itself.
    loop {
        let again = [&keep[..], &["--resume", &kept]].concat();
        let mut child = command(&render(&out, &again)).spawn().expect("the program starts");
        wait_for(&kept, &mut child);
        thread::sleep(Duration::from_millis(5 + 40 * kills));
        if kills < 6 {
            // Whatever it was doing, writing a checkpoint most of the time.
            child.kill().expect("a child can be killed");
            child.wait().expect("it ends");
            kills += 1;
            assert!(Path::new(&kept).exists());
        } else {
            let output = child.wait_with_output().expect("it ends");
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            break;
        }
    }
    same(&out, &whole);
}

/// Sums are kept in blocks of sixteen samples: wherever in a block a render was cut, it goes on to the same bits.
#[test]
fn a_render_is_cut_after_every_sample_of_a_block() {
    let folder = folder("parts/cuts");
    let file = |name: &str| path(&folder, name);
    let (whole, out, kept) = (file("whole.exr"), file("out.exr"), file("kept.exr"));
    let render = |out: &str, spp: &str, more: &[&str]| {
        succeeds(&[&["render", SCENE, "-o", out, "--width", "9", "--spp", spp, "--quiet"], more].concat());
    };
    const LAST: u32 = 35;
    render(&whole, &LAST.to_string(), &[]);
    for samples in 1..=LAST {
        render(&out, &samples.to_string(), &["--checkpoint", &kept, "--resume", &kept]);
    }
    same(&out, &whole);
}

#[test]
fn a_checkpoint_of_another_render_is_refused_with_the_difference() {
    let folder = folder("parts/other-render");
    let (out, kept) = (path(&folder, "out.exr"), path(&folder, "kept.exr"));
    succeeds(&render(&out, &["--checkpoint", &kept]));
    let resumed = |more: &[&str], message: &str| {
        fails(&render(&out, &[&["--resume", &kept], more].concat()), 1, message);
    };
    resumed(&["--seed", "3"], "the seed is 0 there and 3 here");
    resumed(
        &["--integrator", "direct"],
        "the integrator is path, max_depth 6, rr_depth 5 there and direct here",
    );
    resumed(&["--height", "50"], "the film is 70 x 70, box, rgb there and 70 x 50, box, rgb here");
    resumed(&["--aov", "depth"], "the list of channels is R, G, B there and R, G, B, depth.Z here");
    resumed(&["--shard", "1/2"], "the shard is 1/1 there and 1/2 here");
    let other = path(&folder, "other.xml");
    let text = fs::read_to_string(SCENE).expect("readable");
    fs::write(&other, text.replacen("</scene>", "<shape type=\"sphere\"/></scene>", 1)).expect("writable");
    let arguments = [&["render", &other, "-o", &out, "--resume", &kept], &PICTURE[..]].concat();
    fails(&arguments, 1, "is of another render: the scene is ");
    fails(&render(&out, &["--resume", "no-such-file"]), 1, "no-such-file: there is no such file");
    let mut damaged = bytes(&kept);
    let at = damaged.len() - 500;
    damaged[at] ^= 1;
    fs::write(&kept, damaged).expect("writable");
    resumed(&[], "it is damaged");
}

#[test]
fn a_finished_render_goes_on_to_more_samples() {
    let folder = folder("parts/more");
    let file = |name: &str| path(&folder, name);
    let (kept, out, whole) = (file("kept.exr"), file("out.exr"), file("whole.exr"));
    let render = |out: &str, more: &[&str]| {
        succeeds(&[&["render", SCENE, "-o", out, "--width", "40", "--quiet"], more].concat());
    };
    render(&out, &["--spp", "21", "--checkpoint", &kept]);
    render(&whole, &["--spp", "50"]);
    let goes_on = |more: &str| {
        let output = packlight(&[
            "render", SCENE, "-o", &out, "--width", "40", "--spp", "50", "--resume", &kept, more,
        ]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        same(&out, &whole);
        stdout(&output)
    };
    let text = goes_on("--stats");
    assert!(
        text.starts_with(&format!("{kept} has 21 of 50 samples a pixel; going on from there\n")),
        "{text}"
    );
    assert_eq!(goes_on("--quiet"), "");
    let all = packlight(&["render", SCENE, "-o", &out, "--width", "40", "--spp", "21", "--resume", &kept]);
    let text = stdout(&all);
    assert!(
        text.starts_with(&format!("{kept} has 21 samples a pixel; nothing is left to render\n")),
        "{text}"
    );
    assert!(!text.contains("profile"), "{text}");
    assert!(goes_on("--json").starts_with('{'));
}

#[test]
fn a_checkpoint_of_another_version_is_refused() {
    let folder = folder("parts/other-version");
    let (out, kept) = (path(&folder, "out.exr"), path(&folder, "kept.exr"));
    succeeds(&render(&out, &["--checkpoint", &kept]));
    let file = bytes(&kept);
    // The part stands behind the picture: its length, and a mark.
    let (rest, length) = file[..file.len() - 8].split_last_chunk().expect("a length");
    let length = usize::try_from(u64::from_le_bytes(*length)).expect("a length");
    let (picture, part) = rest.split_at(rest.len() - length);
    let mut part = Part::from_bytes(part).expect("a part");
    let version = part.facts.iter_mut().find(|(name, _)| name == "version").expect("it is said");
    assert_eq!(version.1, env!("CARGO_PKG_VERSION"));
    version.1 = "0.0.1".into();
    let part = part.to_bytes();
    fs::write(&kept, [picture, &part, &part.len().to_le_bytes(), &file[file.len() - 8..]].concat())
        .expect("writable");
    let message = format!("the version is 0.0.1 there and {} here", env!("CARGO_PKG_VERSION"));
    fails(&render(&out, &["--resume", &kept]), 1, &message);
}

#[test]
fn what_was_spent_before_counts() {
    let loaded = load(Path::new(SCENE), &LoadOptions::default()).expect("it loads");
    let scene = compile(&loaded.description).expect("it compiles");
    let mut part = Frame::new(&scene, Plan::default()).part("", &[]);
    part.time = Duration::from_secs(1000);
    let frame = Frame::resume(&scene, Plan::default(), &[], part).expect("it is of the same render");
    assert!(frame.develop().statistics.time >= Duration::from_secs(1000));
    // And is kept for whoever goes on from there.
    assert!(frame.part("", &[]).time >= Duration::from_secs(1000));
}

/// Long enough to be stopped by hand.
const ENDLESS: [&str; 4] = ["--spp", "1000000", "--threads", "2"];

#[cfg(unix)]
#[test]
fn a_signal_writes_what_is_there_and_says_how_much() {
    for (name, signal) in [("int", "-INT"), ("term", "-TERM")] {
        let folder = folder(&format!("parts/signal-{name}"));
        let file = |name: &str| path(&folder, name);
        let (out, kept, png) = (file("out.exr"), file("kept.exr"), file("out.png"));
        for (target, keeps) in [(&out, vec!["--checkpoint", &kept, "--every", "10ms"]), (&png, vec![])] {
            let arguments =
                [&["render", SCENE, "-o", target, "--width", "40"], &ENDLESS[..], &keeps[..]].concat();
            let mut child = command(&arguments).spawn().expect("the program starts");
            if keeps.is_empty() {
                thread::sleep(Duration::from_millis(1500));
            } else {
                wait_for(&kept, &mut child);
            }
            let killed = Command::new("kill").args([signal, &child.id().to_string()]).status();
            assert!(killed.is_ok_and(|status| status.success()));
            let output = child.wait_with_output().expect("it ends");
            assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
            let told = stderr(&output);
            assert!(told.contains("stopped: ") && told.contains(" of 1,000,000 samples a pixel"), "{told}");
            let way_on = match keeps.is_empty() {
                true => "; what is to be continued needs an .exr, or a --checkpoint\n".into(),
                false => format!("; --resume {out} continues it\n"),
            };
            assert!(told.ends_with(&way_on), "{told}");
            assert!(Path::new(target).exists());
        }
        // What was stopped is a part: it can be continued, and to the same bits as the checkpoint.
        let whole = file("whole.exr");
        let few = ["--width", "40", "--quiet"];
        succeeds(
            &[
                &["render", SCENE, "-o", &whole, "--spp", "1000000", "--resume", &out, "--time-limit", "1ms"],
                &few[..],
            ]
            .concat(),
        );
    }
}

#[test]
fn a_time_limit_is_kept_and_what_is_there_goes_on() {
    let folder = folder("parts/time-limit");
    let out = path(&folder, "out.exr");
    let start = Instant::now();
    let arguments = ["render", SCENE, "-o", &out, "--width", "40", "--time-limit", "500ms", "--json"];
    let mut child = command(&[&arguments[..], &ENDLESS[..]].concat()).spawn().expect("the program starts");
    while child.try_wait().expect("a child can be asked").is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().expect("a child can be killed");
            panic!("it goes on after half a second");
        }
        thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().expect("it ended");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let (least, most) = (json["samples_least"].as_u64(), json["samples_most"].as_u64());
    assert!(most > Some(0) && most < Some(1_000_000) && json["complete"] == false, "{json}");
    assert!(least.unwrap_or(0) * 2 >= most.unwrap_or(9) - 1, "{json}");
}

#[test]
fn a_target_error_stops_by_tiles_the_same_on_any_thread() {
    let folder = folder("parts/target-error");
    let file = |name: &str| path(&folder, name);
    let picture = ["--width", "70", "--spp", "512", "--target-error", "0.05", "--quiet"];
    let outs = ["1", "3"].map(|threads| {
        let out = file(&format!("{threads}.exr"));
        succeeds(&[&["render", SCENE, "-o", &out, "--threads", threads], &picture[..]].concat());
        out
    });
    same(&outs[0], &outs[1]);
    // Shards of tiles decide alike.
    let parts = ["1/2", "2/2"].map(|which| {
        let out = file(&which.replace('/', "-"));
        let out = format!("{out}.exr");
        succeeds(&[&["render", SCENE, "-o", &out, "--shard", which], &picture[..]].concat());
        out
    });
    let merged = file("merged.exr");
    succeeds(&["merge", &parts[0], &parts[1], "-o", &merged, "--quiet"]);
    same(&merged, &outs[0]);
    let header = packlight::picture::exr_attributes(&bytes(&merged));
    let samples = header.iter().find(|(name, _)| name == "packlight.samples").expect("it is said");
    assert!(samples.1.ends_with(" of 512") && samples.1.starts_with("64"), "{samples:?}");
}

/// Which tiles are done is decided by sums that a part keeps: wherever it was cut, the same tiles are.
#[test]
fn a_target_error_that_was_interrupted_is_resumed_to_the_bit() {
    let folder = folder("parts/target-error-resumed");
    let file = |name: &str| path(&folder, name);
    let (whole, out, kept) = (file("whole.exr"), file("out.exr"), file("kept.exr"));
    let adaptive = |out: &str, spp: &str, more: &[&str]| -> Vec<String> {
        let words = ["render", SCENE, "-o", out, "--width", "70", "--spp", spp, "--quiet"];
        let error = ["--target-error", "0.05", "--threads", "2"];
        [&words[..], &error, more].concat().into_iter().map(String::from).collect()
    };
    let run = |arguments: &[String]| succeeds(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    let began = Instant::now();
    run(&adaptive(&whole, "512", &[]));
    let time = began.elapsed();
    // Tiles stop at different numbers of samples, and not all of them by the error.
    let samples = |file: &str| {
        let said = packlight::picture::exr_attributes(&bytes(file));
        said.into_iter().find(|(name, _)| name == "packlight.samples").expect("it is said").1
    };
    assert!(samples(&whole).ends_with(" of 512") && samples(&whole).contains(" to "), "{}", samples(&whole));

    // Killed, again and again, and at the end not any more.
    let again = adaptive(&out, "512", &["--checkpoint", &kept, "--every", "1ms", "--resume", &kept]);
    let again: Vec<&str> = again.iter().map(String::as_str).collect();
    for kill in 0..6 {
        let mut child = command(&again).spawn().expect("the program starts");
        wait_for(&kept, &mut child);
        thread::sleep(Duration::from_millis(5 + 60 * kill));
        child.kill().expect("a child can be killed");
        child.wait().expect("it ends");
    }
    succeeds(&again);
    same(&out, &whole);

    // Stopped by its limit, however fast the machine is, and resumed from the picture.
    let stopped = file("stopped.exr");
    let mut limit = time.as_millis();
    loop {
        limit /= 2;
        assert!(limit > 0, "it ends in a millisecond");
        run(&adaptive(&stopped, "512", &["--time-limit", &format!("{limit}ms")]));
        if samples(&stopped) != samples(&whole) {
            break;
        }
    }
    run(&adaptive(&out, "512", &["--resume", &stopped]));
    same(&out, &whole);

    // Ended at fewer samples, in the middle of a block of sixteen or at its end, and gone on to more.
    for fewer in ["40", "96"] {
        run(&adaptive(&file("fewer.exr"), fewer, &["--checkpoint", &kept]));
        run(&adaptive(&out, "512", &["--resume", &kept]));
        same(&out, &whole);
    }
}

#[test]
fn a_folder_that_goes_away_costs_no_samples() {
    let folder = folder("parts/gone");
    let gone = folder.join("gone");
    fs::create_dir(&gone).expect("a folder can be made");
    let (out, kept) = (path(&gone, "out.exr"), path(&folder, "kept.exr"));
    let whole = path(&folder, "whole.exr");
    succeeds(&render(&whole, &[]));
    let keep = ["--checkpoint", &kept, "--every", "1ms"];
    let mut child = command(&render(&out, &keep)).spawn().expect("the program starts");
    wait_for(&kept, &mut child);
    fs::remove_dir(&gone).expect("an empty folder can be removed");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let rescued = path(&folder, "out.rescued.exr");
    assert!(stderr(&output).contains(&format!("what was rendered is in {rescued}")), "{}", stderr(&output));
    let out = path(&folder, "out.exr");
    succeeds(&render(&out, &["--resume", &rescued]));
    same(&out, &whole);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_costs_no_samples_and_no_old_picture() {
    let folder = folder("parts/full");
    let (mount, here) = (folder.join("disk"), folder.join("here"));
    fs::create_dir(&mount).expect("a folder can be made");
    fs::create_dir(&here).expect("a folder can be made");
    let disk = mount.display();
    let script = |then: &str| {
        let program = env!("CARGO_BIN_EXE_packlight");
        let text = format!(
            "mount -t tmpfs -o size=16k none {disk} || exit 99; echo old > {disk}/out.exr; cd {}; \
             {program} render {SCENE} -o {disk}/out.exr --quiet {}; code=$?; {then}; exit $code",
            here.display(),
            PICTURE.join(" ")
        );
        Command::new("unshare").args(["-m", "sh", "-c", &text]).output()
    };
    let Ok(output) = script(&format!("cat {disk}/out.exr; ls {disk}")) else {
        println!("skipped: there is no `unshare`");
        return;
    };
    if output.status.code() != Some(1) {
        println!("skipped: a small disk can't be mounted here ({})", stderr(&output));
        assert!(matches!(output.status.code(), Some(99) | None) || stderr(&output).contains("unshare"));
        return;
    }
    assert!(stderr(&output).contains("No space left on device"), "{}", stderr(&output));
    assert!(stderr(&output).contains("what was rendered is in ./out.rescued.exr"), "{}", stderr(&output));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "old\nout.exr\n");
    assert_eq!(names(&here), ["out.rescued.exr"]);
}

#[test]
fn kill_9_leaves_the_old_picture_or_the_new_one() {
    let folder = folder("parts/kill");
    let (whole, out) = (path(&folder, "whole.exr"), path(&folder, "out.exr"));
    succeeds(&render(&whole, &[]));
    let time = Instant::now();
    succeeds(&render(&out, &[]));
    let time = time.elapsed();
    let new = bytes(&out);
    for step in 0..12 {
        fs::write(&out, "old").expect("writable");
        let mut child = command(&render(&out, &[])).spawn().expect("the program starts");
        // More of them near the end, when the file is written.
        thread::sleep(time.mul_f64(1.0 - 0.75f64.powi(step)));
        child.kill().expect("a child can be killed");
        child.wait().expect("it ends");
        let there = bytes(&out);
        assert!(there == b"old" || there == new, "{} bytes are neither", there.len());
    }
}

#[test]
fn a_cluster_is_handed_a_script_and_mistakes_are_told_before() {
    let folder = folder("parts/submit");
    let out = path(&folder, "out.exr");
    let submit = |scene: &str, shards: &str, more: &[&str]| -> Vec<String> {
        let words = ["submit", "slurm", scene, "-o", &out, "--shards", shards];
        [&words[..], more].concat().into_iter().map(String::from).collect()
    };
    let refused = |arguments: Vec<String>, code: i32, part: &str| {
        fails(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), code, part);
        assert_eq!(names(&folder), [""; 0], "{arguments:?}");
    };
    refused(submit(SCENE, "0", &[]), 2, "0 is not in 1..");
    refused(submit("no-such-scene.xml", "4", &[]), 1, "no-such-scene.xml");
    refused(submit(SCENE, "4", &["--", "--no-such-option"]), 2, "--no-such-option");
    refused(submit(SCENE, "4", &["--", "--shard", "1/2"]), 2, "--shard");
    refused(submit(SCENE, "9", &["--shard-by", "samples", "--", "--spp", "40"]), 2, "there are 3 for 9");
    refused(submit(SCENE, "4", &["--sbatch", "a\nb"]), 1, "can't hold");

    let arguments = submit(SCENE, "2", &["--cpus", "2", "--", "--spp", "40", "--width", "70"]);
    let nowhere = path(&folder, "no-path");
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let words = [&words[..7], &["--run"], &words[7..]].concat();
    let output = command(&words).env("PATH", &nowhere).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("there is no sbatch on the PATH"), "{}", stderr(&output));

    // The script is there; in place of Slurm, something that does each task of an array and says a number.
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    succeeds(&words);
    assert_eq!(names(&folder), ["out.2-tiles", "out.slurm.sh"]);
    let bin = folder.join("bin");
    fs::create_dir(&bin).expect("a folder can be made");
    let sbatch = "#!/bin/sh\ncat >\"$0.job\"\ncase \"$*\" in\n*--array=0-1*) for i in 0 1; do\n\
                  SLURM_ARRAY_TASK_ID=$i sh \"$0.job\" >&2 || exit 1; done; echo '7;cluster';;\n\
                  *--dependency=afterok:7\\ *) sh \"$0.job\" >&2 || exit 1; echo 8;;\n*) exit 1;;\nesac\n";
    fs::write(bin.join("sbatch"), sbatch).expect("writable");
    let run = "chmod +x \"$0/sbatch\" && PATH=\"$0:$PATH\" exec sh \"$1\"";
    let output = Command::new("sh").args(["-c", run]).arg(&bin).arg(folder.join("out.slurm.sh")).output();
    let output = output.expect("there is a shell");
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "job 7: 2 shards; job 8: the merge\n");
    let whole = path(&folder, "whole.exr");
    succeeds(&render(&whole, &[]));
    same(&out, &whole);
}
