//! Reading numbers out of buffers. Everything is checked against the bytes that are really there before any
//! element is read, and nothing is allocated in proportion to a number that the file merely claims.

use gltf::json::accessor::{Accessor, ComponentType};
use gltf::json::buffer::View;
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

/// Accessors without a buffer view claim zeros without any bytes to bound them.
const MAX_IMPLIED: usize = 1 << 24;

/// A file's JSON and the bytes of its buffers.
pub(super) struct Document<'a> {
    pub root: Root,
    pub buffers: Vec<std::borrow::Cow<'a, [u8]>>,
}

/// The elements of an accessor, known to be readable.
pub(super) struct Elements<'a> {
    count: usize,
    dimensions: usize,
    component: ComponentType,
    normalized: bool,
    /// `None`: all zeros.
    dense: Option<Strided<'a>>,
    /// Ascending element numbers, and what stands there instead.
    sparse: Option<(Vec<usize>, Strided<'a>)>,
}

/// Elements at equal distances; element i is at `i * stride`.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl Document<'_> {
    /// The bytes of a buffer view and its stride, if it has one.
    pub fn view(&self, index: Index<View>) -> Result<(&[u8], Option<usize>), String> {
        let number = index.value();
        let view = self.root.buffer_views.get(number).ok_or_else(|| format!("there is no buffer view {number}"))?;
        let buffer = view.buffer.value();
        let bytes = self.buffers.get(buffer).ok_or_else(|| format!("there is no buffer {buffer}"))?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        range(bytes, start, view.byte_length.0)
            .map(|bytes| (bytes, view.byte_stride.map(|stride| stride.0)))
            .ok_or_else(|| format!("buffer view {number} reaches past the {} bytes of buffer {buffer}", bytes.len()))
    }

    /// The elements of an accessor.
    pub fn elements(&self, index: Index<Accessor>) -> Result<Elements<'_>, String> {
        let accessor = self.root.accessors.get(index.value()).ok_or("it does not exist")?;
        let Checked::Valid(component) = &accessor.component_type else {
            return Err("unknown component type".to_owned());
        };
        let Checked::Valid(shape) = &accessor.type_ else {
            return Err("unknown element type".to_owned());
        };
        let (component, dimensions) = (component.0, shape.multiplicity());
        let count = usize::try_from(accessor.count.0).map_err(|_| "its count is absurd")?;
        let size = component.size() * dimensions;

        let dense = match accessor.buffer_view {
            Some(view) => Some(self.strided(view, accessor.byte_offset.map_or(0, |o| o.0), count, size)?),
            None if count > MAX_IMPLIED => return Err(format!("{count} elements without a buffer view")),
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => {
                let Checked::Valid(index_type) = &sparse.indices.component_type else {
                    return Err("unknown type of sparse indices".to_owned());
                };
                let replaced = usize::try_from(sparse.count.0).map_err(|_| "its sparse count is absurd")?;
                let width = index_type.0.size();
                let numbers =
                    self.strided(sparse.indices.buffer_view, sparse.indices.byte_offset.0, replaced, width)?;
                let numbers: Vec<usize> =
                    (0..replaced).map(|i| unsigned(numbers.at(i), index_type.0) as usize).collect();
                if !numbers.is_sorted_by(|a, b| a < b) || numbers.last().is_some_and(|&last| last >= count) {
                    return Err("its sparse indices do not ascend within its count".to_owned());
                }
                let values = self.strided(sparse.values.buffer_view, sparse.values.byte_offset.0, replaced, size)?;
                Some((numbers, values))
            }
            None => None,
        };
        Ok(Elements { count, dimensions, component, normalized: accessor.normalized, dense, sparse })
    }

    fn strided(&self, view: Index<View>, offset: u64, count: usize, size: usize) -> Result<Strided<'_>, String> {
        let (bytes, stride) = self.view(view)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!("elements of {size} bytes every {stride}"));
        }
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|last| last.checked_add(size)),
        };
        needed
            .and_then(|needed| range(bytes, offset, needed as u64))
            .map(|bytes| Strided { bytes, stride })
            .ok_or_else(|| format!("{count} elements reach past the {} bytes of buffer view {view}", bytes.len()))
    }
}

impl Elements<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// 1 for scalars, 2 to 4 for vectors.
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// Element `i` as floats; normalised integers as glTF asks. `i` is below [`Self::len`], `N` at most
    /// [`Self::dimensions`].
    pub fn floats<const N: usize>(&self, i: usize) -> [f32; N] {
        match self.bytes(i) {
            Some(bytes) => {
                let size = self.component.size();
                std::array::from_fn(|k| float(&bytes[k * size..], self.component, self.normalized))
            }
            None => [0.0; N],
        }
    }

    /// Element `i` as an index. `i` is below [`Self::len`].
    pub fn index(&self, i: usize) -> u32 {
        self.bytes(i).map_or(0, |bytes| unsigned(bytes, self.component))
    }

    /// Element `i` as unsigned numbers. `i` is below [`Self::len`], `N` at most [`Self::dimensions`].
    pub fn unsigned<const N: usize>(&self, i: usize) -> [u32; N] {
        match self.bytes(i) {
            Some(bytes) => {
                let size = self.component.size();
                std::array::from_fn(|k| unsigned(&bytes[k * size..], self.component))
            }
            None => [0; N],
        }
    }

    /// Whether elements are made of unsigned numbers.
    pub fn are_unsigned(&self) -> bool {
        use ComponentType::{U8, U16, U32};
        matches!(self.component, U8 | U16 | U32)
    }

    /// Whether elements can be indices: unsigned scalars.
    pub fn are_indices(&self) -> bool {
        self.dimensions == 1 && self.are_unsigned()
    }

    fn bytes(&self, i: usize) -> Option<&[u8]> {
        let replaced = self.sparse.as_ref().and_then(|(numbers, values)| {
            let k = numbers.binary_search(&i).ok()?;
            Some(values.at(k))
        });
        replaced.or_else(|| self.dense.as_ref().map(|dense| dense.at(i)))
    }
}

impl<'a> Strided<'a> {
    fn at(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

/// `length` bytes from `start`, if they are there.
fn range(bytes: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let end = usize::try_from(start.checked_add(length)?).ok()?;
    bytes.get(usize::try_from(start).ok()?..end)
}

fn float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    use ComponentType::{F32, I8, I16, U8, U16, U32};
    let (value, most) = match component {
        F32 => return f32::from_le_bytes(head(bytes)),
        I8 => (f32::from(i8::from_le_bytes(head(bytes))), 127.0),
        U8 => (f32::from(bytes[0]), 255.0),
        I16 => (f32::from(i16::from_le_bytes(head(bytes))), 32767.0),
        U16 => (f32::from(u16::from_le_bytes(head(bytes))), 65535.0),
        U32 => (u32::from_le_bytes(head(bytes)) as f32, u32::MAX as f32),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

fn unsigned(bytes: &[u8], component: ComponentType) -> u32 {
    match component {
        ComponentType::U8 => u32::from(bytes[0]),
        ComponentType::U16 => u32::from(u16::from_le_bytes(head(bytes))),
        _ => u32::from_le_bytes(head(bytes)),
    }
}

fn head<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|i| bytes[i])
}
