//! The bytes around a serialized state: a header that identifies it, and a checksum. Numbers are
//! little-endian.
//!
//! ```text
//! "DEA state", layout (u16), GUID (38 characters), length (u32), CRC-32 (u32), the saved instance
//! ```

use crc::{CRC_32_ISO_HDLC, Crc};

use crate::instance::{Fault, STATE_LAYOUT};
use crate::model::Model;

const MAGIC: &[u8] = b"DEA state";
static CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
const LAYOUT: [u8; 2] = STATE_LAYOUT.to_le_bytes();

/// Size of the envelope with these contents.
pub fn size<M: Model>(contents: &[u8]) -> usize {
    header::<M>(contents).len() + contents.len()
}

fn header<M: Model>(contents: &[u8]) -> Vec<u8> {
    let length = contents.len() as u32;
    let checksum = CHECKSUM.checksum(contents);
    [
        MAGIC,
        &LAYOUT,
        M::GUID.as_bytes(),
        &length.to_le_bytes(),
        &checksum.to_le_bytes(),
    ]
    .concat()
}

/// Writes contents with their envelope into a target of the right size.
///
/// # Errors
/// Error for a target of another size; then nothing is written.
pub fn seal<M: Model>(contents: &[u8], target: &mut [u8]) -> Result<(), Fault> {
    let header = header::<M>(contents);
    if target.len() != header.len() + contents.len() {
        return Err(Fault::error(format!(
            "the array has {} bytes; fmi2SerializedFMUstateSize says {}",
            target.len(),
            header.len() + contents.len()
        )));
    }
    let (front, back) = target.split_at_mut(header.len());
    front.copy_from_slice(&header);
    back.copy_from_slice(contents);
    Ok(())
}

/// The contents of an envelope.
///
/// # Errors
/// Error for bytes that are no serialized state, of another version of this FMU
/// or damaged.
pub fn open<M: Model>(sealed: &[u8]) -> Result<&[u8], Fault> {
    let fault = |why: &str| Fault::error(format!("the bytes are no state of this FMU: {why}"));
    let rest = sealed
        .strip_prefix(MAGIC)
        .ok_or_else(|| fault("they do not begin like one"))?;
    let rest = rest
        .strip_prefix(&LAYOUT)
        .and_then(|rest| rest.strip_prefix(M::GUID.as_bytes()))
        .ok_or_else(|| fault("they are of another FMU, or of another version of it"))?;
    let (sizes, contents) = rest
        .split_at_checked(8)
        .ok_or_else(|| fault("they are incomplete"))?;
    if sizes[..4] != (contents.len() as u32).to_le_bytes() {
        return Err(fault("their length is not the one that they say"));
    }
    if sizes[4..] != CHECKSUM.checksum(contents).to_le_bytes() {
        return Err(fault("their checksum is wrong"));
    }
    Ok(contents)
}
