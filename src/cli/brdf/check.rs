//! The certificate as a table.

use crate::lobe::Certificate;

/// One line a question; the last word is the verdict.
pub(super) fn table(title: &str, certificate: &Certificate) -> String {
    let rows = &certificate.rows;
    let width = |text: fn(&crate::lobe::Row) -> &str| {
        rows.iter().map(|row| text(row).chars().count()).max().unwrap_or(0)
    };
    let (property, how) = (width(|row| row.property), width(|row| &row.how));
    let found = width(|row| &row.found);
    let mut text = format!("{title}\n");
    for row in rows {
        let verdict = match row.passed {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "",
        };
        let line = format!("  {:property$}  {:how$}  {:found$}  {verdict}", row.property, row.how, row.found);
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::Row;

    #[test]
    fn columns_are_aligned_and_verdicts_stand_last() {
        let row =
            |property, found: &str, passed| Row { property, how: "θ".into(), found: found.into(), passed };
        let rows =
            vec![row("a", "good", Some(true)), row("abc", "so so", None), row("b", "bad", Some(false))];
        let text = table("model", &Certificate { rows });
        assert_eq!(text, "model\n  a    θ  good   yes\n  abc  θ  so so\n  b    θ  bad    NO\n");
    }
}
