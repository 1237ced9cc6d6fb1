//! Text in the header of an OpenEXR file.
//!
//! The crate `exr` keeps attributes in a hash table and writes them in an order that changes from run to
//! run. Here they are put into the finished file in the order given, so that the same picture gives the
//! same bytes.

/// Magic and version, before the first attribute.
const START: usize = 8;

/// Inserts attributes of the type `string` before all others of the first header.
///
/// `file` is a whole one of one layer in scan lines; in its place, for a copy of it would take as much memory again.
pub(super) fn insert(mut file: Vec<u8>, attributes: &[(String, String)]) -> Result<Vec<u8>, String> {
    let mut inserted = Vec::new();
    for (name, value) in attributes {
        // Longer names need a flag that old readers don't know.
        if name.is_empty() || name.len() > 31 || name.contains('\0') {
            return Err(format!("`{name}` is no name for an attribute of an EXR file"));
        }
        inserted.extend(name.bytes().chain(*b"\0string\0"));
        inserted.extend((value.len() as u32).to_le_bytes());
        inserted.extend(value.bytes());
    }
    let damaged = || "the file has no header".to_owned();
    let table = header_end(&file).ok_or_else(damaged)?;
    // The table of offsets follows the header, and ends where the first chunk begins.
    let first = file.get(table..table + 8).and_then(|entry| entry.try_into().ok()).map(u64::from_le_bytes);
    let end = first.and_then(|first| usize::try_from(first).ok()).ok_or_else(damaged)?;
    let entries = file.get_mut(table..end).ok_or_else(damaged)?;
    for entry in entries.as_chunks_mut::<8>().0 {
        *entry = (u64::from_le_bytes(*entry) + inserted.len() as u64).to_le_bytes();
    }
    file.splice(START..START, inserted);
    Ok(file)
}

/// The attributes of the type `string` in the first header.
pub(super) fn strings(bytes: &[u8]) -> Vec<(String, String)> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let named = |(name, kind, value): Attribute| (kind == b"string").then(|| (text(name), text(value)));
    attributes(bytes).filter_map(named).collect()
}

/// Name, type and value.
type Attribute<'a> = (&'a [u8], &'a [u8], &'a [u8]);

/// Whatever attributes there are, until the header ends or makes no sense any more.
fn attributes(bytes: &[u8]) -> impl Iterator<Item = Attribute<'_>> {
    let mut rest = bytes.get(START..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (attribute, behind) = split_attribute(rest)?;
        rest = behind;
        Some(attribute)
    })
}

fn split_attribute(bytes: &[u8]) -> Option<(Attribute<'_>, &[u8])> {
    let (name, rest) = split_name(bytes)?;
    let (kind, rest) = split_name(rest)?;
    let (size, rest) = rest.split_first_chunk()?;
    let (value, rest) = rest.split_at_checked(u32::from_le_bytes(*size) as usize)?;
    (!name.is_empty()).then_some(((name, kind, value), rest))
}

/// Up to a zero, and what is behind it.
fn split_name(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|&byte| byte == 0)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// The first byte behind the header: a name of no letters ends it.
fn header_end(bytes: &[u8]) -> Option<usize> {
    let sizes = attributes(bytes).map(|(name, kind, value)| name.len() + kind.len() + value.len() + 6);
    let end = START + sizes.sum::<usize>();
    (bytes.get(end) == Some(&0)).then_some(end + 1)
}
