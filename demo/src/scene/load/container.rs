//! The GLB container: a JSON chunk and at most one binary chunk that counts.

use super::error::Problem;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;
const HEADER_LEN: usize = 12;

/// The JSON text of a .gltf or .glb file, and the binary chunk if there is one.
pub(super) fn split(file: &[u8]) -> Result<(&[u8], Option<&[u8]>), Problem> {
    if !file.starts_with(MAGIC) {
        // Byte order marks are forbidden, common and harmless.
        return Ok((unpadded(file.strip_prefix(b"\xef\xbb\xbf").unwrap_or(file)), None));
    }
    let broken = |reason: &str| Problem::Container { reason: reason.to_owned() };

    let (Some(version), Some(length)) = (word(file, 4), word(file, 8)) else {
        return Err(broken("the header is cut short"));
    };
    if version != 2 {
        return Err(Problem::Version(version.to_string()));
    }
    let mut rest =
        file.get(HEADER_LEN..length as usize).ok_or_else(|| broken("its stated length is not that of the file"))?;

    let (kind, json) = next_chunk(&mut rest).ok_or_else(|| broken("the first chunk is cut short"))?;
    if kind != JSON {
        return Err(broken("the first chunk is not JSON"));
    }
    let mut bin = None;
    while !rest.is_empty() {
        let (kind, data) = next_chunk(&mut rest).ok_or_else(|| broken("a chunk is cut short"))?;
        match kind {
            BIN if bin.is_none() => bin = Some(data),
            BIN | JSON => return Err(broken("there is a second JSON or binary chunk")),
            // The specification reserves other chunks for extensions and says to skip them.
            _ => {}
        }
    }
    Ok((unpadded(json), bin))
}

/// The text without what pads it: spaces, or the zeros that some writers use.
fn unpadded(json: &[u8]) -> &[u8] {
    let end = json.iter().rposition(|byte| *byte != 0 && !byte.is_ascii_whitespace()).map_or(0, |last| last + 1);
    &json[..end]
}

/// Takes a chunk's type and data off the front.
fn next_chunk<'a>(rest: &mut &'a [u8]) -> Option<(u32, &'a [u8])> {
    let (length, kind) = (word(rest, 0)? as usize, word(rest, 4)?);
    let data = rest.get(8..)?.get(..length)?;
    *rest = &rest[8 + length..];
    Some((kind, data))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let body: Vec<u8> = chunks
            .iter()
            .flat_map(|(kind, data)| [&(data.len() as u32).to_le_bytes(), &kind.to_le_bytes(), *data].concat())
            .collect();
        [MAGIC, &2u32.to_le_bytes()[..], &((HEADER_LEN + body.len()) as u32).to_le_bytes(), &body].concat()
    }

    #[test]
    fn plain_json_is_passed_on() {
        assert_eq!(split(b"\xef\xbb\xbf{}").unwrap(), (&b"{}"[..], None));
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let file = glb(&[(JSON, b"{}  "), (7, b"junk"), (BIN, b"data")]);
        assert_eq!(split(&file).unwrap(), (&b"{}"[..], Some(&b"data"[..])));
    }

    #[test]
    fn json_may_be_padded_with_zeros() {
        for padded in [&b"{}\0\0"[..], b"{} \n", b"{}\0 \0\r\n"] {
            assert_eq!(split(&glb(&[(JSON, padded)])).unwrap().0, b"{}");
            assert_eq!(split(padded).unwrap().0, b"{}");
        }
        assert_eq!(split(b"{\0}").unwrap().0, b"{\0}", "inside it is the parser's to refuse");
        assert_eq!(split(b"\0").unwrap().0, b"");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let file = glb(&[(JSON, b"{}  "), (BIN, b"data")]);
        for end in MAGIC.len()..file.len() {
            assert!(split(&file[..end]).is_err(), "cut at {end}");
        }
    }

    #[test]
    fn wrong_chunks_are_refused() {
        assert!(split(&glb(&[(BIN, b"data")])).is_err());
        assert!(split(&glb(&[(JSON, b"{}"), (JSON, b"{}")])).is_err());
        assert!(split(&glb(&[(JSON, b"{}"), (BIN, b"a"), (BIN, b"b")])).is_err());
    }
}
