//! Messages of Protocol Buffers, as bytes: the three of its encodings that the fields of OSI need
//! (<https://protobuf.dev/programming-guides/encoding>).

/// A message.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Message(Vec<u8>);

impl Message {
    /// With an integer or an enumeration's number in a field.
    #[must_use]
    pub fn number(self, field: u64, value: u64) -> Self {
        self.varint(field << 3).varint(value)
    }

    /// With a `double` in a field.
    #[must_use]
    pub(crate) fn double(self, field: u64, value: f64) -> Self {
        self.varint(field << 3 | 1).bytes(&value.to_le_bytes())
    }

    /// With a message in a field.
    #[must_use]
    pub fn message(self, field: u64, message: Self) -> Self {
        self.lengthy(field, &message.0)
    }

    /// With a text in a field.
    #[must_use]
    pub fn text(self, field: u64, text: &str) -> Self {
        self.lengthy(field, text.as_bytes())
    }

    /// Its bytes.
    pub fn encoded(&self) -> &[u8] {
        &self.0
    }

    fn lengthy(self, field: u64, bytes: &[u8]) -> Self {
        self.varint(field << 3 | 2).varint(bytes.len() as u64).bytes(bytes)
    }

    fn varint(mut self, mut value: u64) -> Self {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
        self
    }

    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_specification_have_its_bytes() {
        assert_eq!(Message::default().number(1, 150).encoded(), [0x08, 0x96, 0x01]);
        let testing = [&[0x12, 0x07][..], b"testing"].concat();
        assert_eq!(Message::default().text(2, "testing").encoded(), testing);
        let inner = Message::default().number(1, 150);
        assert_eq!(Message::default().message(3, inner).encoded(), [0x1a, 0x03, 0x08, 0x96, 0x01]);
    }
}
