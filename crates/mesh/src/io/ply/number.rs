//! The types of numbers in PLY.

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    /// The type by either of its names.
    pub(super) fn of_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a number in binary files.
    pub(in crate::io) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// What stands for full intensity in colors of this type.
    pub(super) fn full_intensity(self) -> f64 {
        match self {
            Self::U8 => u8::MAX.into(),
            Self::U16 => u16::MAX.into(),
            _ => 1.0,
        }
    }

    /// The number at the beginning of `bytes`.
    ///
    /// # Panics
    /// If there are fewer bytes than its size.
    #[inline]
    pub(in crate::io) fn decode(self, bytes: &[u8], order: ByteOrder) -> f64 {
        match self {
            Self::I8 => f64::from(bytes[0] as i8),
            Self::U8 => f64::from(bytes[0]),
            Self::I16 => f64::from(u16::from_le_bytes(order.little(bytes)) as i16),
            Self::U16 => f64::from(u16::from_le_bytes(order.little(bytes))),
            Self::I32 => f64::from(u32::from_le_bytes(order.little(bytes)) as i32),
            Self::U32 => f64::from(u32::from_le_bytes(order.little(bytes))),
            Self::F32 => f64::from(f32::from_le_bytes(order.little(bytes))),
            Self::F64 => f64::from_le_bytes(order.little(bytes)),
        }
    }
}

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// The first `N` bytes, the lowest first; those of a number turned for this order, too.
    #[inline]
    pub(in crate::io) fn little<const N: usize>(self, bytes: &[u8]) -> [u8; N] {
        let mut turned: [u8; N] = std::array::from_fn(|byte| bytes[byte]);
        if self == Self::Big {
            turned.reverse();
        }
        turned
    }
}
