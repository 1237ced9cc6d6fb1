//! Elements that lead elsewhere: to another file, another folder, another name.

use super::*;

/// Files that include files that include files …
const MAX_INCLUDE_DEPTH: usize = 16;
/// Includes in one scene: a few files that include each other twice make thousands.
const MAX_INCLUDES: usize = 1024;

impl Reader {
    /// Reads the elements of another file as if they stood here.
    pub(super) fn include(
        &mut self,
        source: &Arc<Source>,
        xml: XmlNode,
        depth: usize,
        entries: &mut Vec<Entry>,
    ) -> Result<(), LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let file = attributes.require("filename")?;
        attributes.finish()?;
        no_children(source, xml)?;
        let path = self.document.folders.file(&file.span, &file.value)?;
        let canonical = fs::canonicalize(&path)
            .map_err(|e| file.error(format!("`{}` can't be included: {e}", file.value)))?;
        if self.open.contains(&canonical) {
            return Err(file
                .error(format!("`{}` includes itself", file.value))
                .help("break the loop: move what both files need into a third one"));
        }
        self.includes += 1;
        if self.open.len() > MAX_INCLUDE_DEPTH || self.includes > MAX_INCLUDES {
            return Err(file.error(format!(
                "includes are nested more than {MAX_INCLUDE_DEPTH} deep or number more than {MAX_INCLUDES}"
            )));
        }
        self.open.push(canonical);
        let included = Source::read(&path)?;
        let xml = parse(&included)?;
        let root = xml.root_element();
        if root.tag_name().name() == "scene" {
            check_version(&mut self.attributes(&included, root)?)?;
            self.read_entries(&included, root, depth, entries)?;
        } else {
            self.read_child(&included, root, depth, entries)?;
        }
        self.open.pop();
        Ok(())
    }

    /// `<path>`: a folder in which files are looked for from here on.
    pub(super) fn path(&mut self, source: &Arc<Source>, xml: XmlNode) -> Result<(), LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let value = attributes.require("value")?;
        let tag = attributes.tag.clone();
        attributes.finish()?;
        no_children(source, xml)?;
        top_level(&tag, xml)?;
        let folder = self.document.folders.folder(&value.span, &value.value)?;
        self.document.folders.prepend(folder);
        Ok(())
    }

    /// `<alias>`: another name for an object that has one.
    pub(super) fn alias(&mut self, source: &Arc<Source>, xml: XmlNode) -> Result<(), LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let id = attributes.require("id")?;
        let other = attributes.require("as")?;
        let tag = attributes.tag.clone();
        attributes.finish()?;
        no_children(source, xml)?;
        top_level(&tag, xml)?;
        let Some(&place) = self.document.ids.get(&id.value) else {
            let mut known: Vec<&str> = self.document.ids.keys().map(String::as_str).collect();
            known.sort_unstable();
            return Err(id
                .error(format!("no object before this has the id `{}`", id.value))
                .label("unknown id")
                .help(did_you_mean(&id.value, known, "the ids so far")));
        };
        self.document.add_id(&other, place)
    }
}

fn top_level(tag: &Span, xml: XmlNode) -> Result<(), LoadError> {
    let name = xml.tag_name().name();
    match xml.parent_element().is_none_or(|parent| parent.tag_name().name() == "scene") {
        true => Ok(()),
        false => Err(tag.error(format!("`{name}` stands in the scene, not inside an object"))),
    }
}
