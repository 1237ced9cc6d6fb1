//! The certificate as a table.

use crate::lobe::Certificate;

/// One line a question, with the verdict before what was found, which may be longer than a terminal is wide.
pub(super) fn table(title: &str, certificate: &Certificate) -> String {
    let rows = &certificate.rows;
    let property = rows.iter().map(|row| row.property.chars().count()).max().unwrap_or(0);
    let mut text = format!("{title}\n");
    for row in rows {
        let verdict = match row.passed {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "",
        };
        text += &format!("  {:property$}  {verdict:3}  {}: {}\n", row.property, row.how, row.found);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::Row;

    #[test]
    fn verdicts_stand_in_a_column() {
        let row =
            |property, found: &str, passed| Row { property, how: "θ".into(), found: found.into(), passed };
        let rows =
            vec![row("a", "good", Some(true)), row("abc", "so so", None), row("b", "bad", Some(false))];
        let text = table("model", &Certificate { rows });
        assert_eq!(text, "model\n  a    yes  θ: good\n  abc       θ: so so\n  b    NO   θ: bad\n");
    }
}
