//! The script that submits an array of shards and its merge.

use std::fmt;

/// A render as two jobs of Slurm. Paths are relative to `here`.
#[derive(Clone, Debug)]
pub(super) struct Script {
    /// Folder that the jobs start in.
    pub(super) here: String,
    pub(super) program: String,
    pub(super) scene: String,
    pub(super) output: String,
    /// Parts, checkpoints and logs.
    pub(super) folder: String,
    /// Name of the jobs in the queue.
    pub(super) name: String,
    pub(super) shards: u32,
    pub(super) by: &'static str,
    pub(super) cpus: u32,
    /// Options of sbatch.
    pub(super) sbatch: Vec<String>,
    /// Options of render.
    pub(super) options: Vec<String>,
}

impl fmt::Display for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shards, by, cpus, .. } = self;
        let last = shards - 1;
        let [here, program, scene, output, folder] =
            [&self.here, &self.program, &self.scene, &self.output, &self.folder].map(|word| quoted(word));
        // sbatch replaces `%a` and its kind, and takes `%%` for a percent sign.
        let logs = quoted(&self.folder.replace('%', "%%"));
        let [array, merge] = ["", "-merge"].map(|end| quoted(&format!("{}{end}", self.name)));
        let [sbatch, options] = [&self.sbatch, &self.options]
            .map(|words| words.iter().map(|word| format!(" {}", quoted(word))).collect::<String>());
        write!(
            f,
            "#!/bin/sh\n\
             # Renders {shards} shards and merges them. Run again, it goes on from their checkpoints.\n\
             set -eu\n\
             cd {here}\n\
             mkdir -p {folder}\n\
             \n\
             array=$(sbatch --parsable --job-name={array} --array=0-{last} --requeue --open-mode=append \
             --cpus-per-task={cpus} --output={logs}/%a.log{sbatch} <<'SHARD'\n\
             #!/bin/sh\n\
             part={folder}/part-$SLURM_ARRAY_TASK_ID.exr\n\
             kept={folder}/kept-$SLURM_ARRAY_TASK_ID.exr\n\
             exec {program} render {scene} -o \"$part\" --shard-from SLURM_ARRAY_TASK_ID --shards {shards} \
             --shard-by {by} --checkpoint \"$kept\" --resume \"$kept\" --threads {cpus}{options}\n\
             SHARD\n\
             )\n\
             # On a federation of clusters the number is followed by a semicolon and a name.\n\
             array=${{array%%;*}}\n\
             \n\
             merge=$(sbatch --parsable --job-name={merge} --dependency=\"afterok:$array\" \
             --kill-on-invalid-dep=yes --requeue --open-mode=append --output={logs}/merge.log{sbatch} <<'MERGE'\n\
             #!/bin/sh\n\
             exec {program} merge {folder}/part-*.exr -o {output}\n\
             MERGE\n\
             )\n\
             echo \"job $array: {shards} shards; job ${{merge%%;*}}: the merge\"\n"
        )
    }
}

/// A word of a POSIX shell: as it is if nothing in it means anything, else in quotes.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script() -> Script {
        Script {
            here: "/home/me".into(),
            program: "/opt/packlight".into(),
            scene: "rooms/a room.xml".into(),
            output: "it's.exr".into(),
            folder: "it's.16-tiles".into(),
            name: "it's".into(),
            shards: 16,
            by: "tiles",
            cpus: 8,
            sbatch: vec!["--partition=long".into()],
            options: vec!["-D".into(), "sky=$HOME".into()],
        }
    }

    #[test]
    fn words_are_what_they_were() {
        for (word, expected) in
            [("a/b-1.exr", "a/b-1.exr"), ("", "''"), ("a b", "'a b'"), ("$(x)", "'$(x)'"), ("~", "'~'")]
        {
            assert_eq!(quoted(word), expected);
        }
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }

    #[test]
    fn a_script_has_an_array_and_a_merge_that_waits() {
        let text = script().to_string();
        for line in [
            "cd /home/me",
            r"mkdir -p 'it'\''s.16-tiles'",
            r"array=$(sbatch --parsable --job-name='it'\''s' --array=0-15 --requeue --open-mode=append --cpus-per-task=8 --output='it'\''s.16-tiles'/%a.log --partition=long <<'SHARD'",
            r"kept='it'\''s.16-tiles'/kept-$SLURM_ARRAY_TASK_ID.exr",
            r#"exec /opt/packlight render 'rooms/a room.xml' -o "$part" --shard-from SLURM_ARRAY_TASK_ID --shards 16 --shard-by tiles --checkpoint "$kept" --resume "$kept" --threads 8 -D 'sky=$HOME'"#,
            r"exec /opt/packlight merge 'it'\''s.16-tiles'/part-*.exr -o 'it'\''s.exr'",
        ] {
            assert!(text.lines().any(|there| there == line), "{line}\nis not in\n{text}");
        }
        assert!(text.contains(r#"--dependency="afterok:$array" --kill-on-invalid-dep=yes"#), "{text}");
    }

    #[test]
    fn a_percent_sign_in_a_folder_is_no_pattern() {
        let text = Script { folder: "50%a".into(), ..script() }.to_string();
        assert!(text.contains("--output=50%%a/%a.log") && text.contains("mkdir -p 50%a\n"), "{text}");
    }
}
