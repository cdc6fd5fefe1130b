//! What requirements see of a value.

/// A value of a parameter on which requirements can be checked: numbers, lists of them, texts.
pub trait Inspect {
    /// Hands over each number with its places in the lists around it, none for a number that is in no list.
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64));

    /// How many elements a list has, or characters a text beside white space; nothing for a number.
    fn length(&self) -> Option<usize> {
        None
    }

    /// The value, where it is a text.
    fn text(&self) -> Option<&str> {
        None
    }
}

macro_rules! inspect_numbers {
    ($($number:ty)*) => {
        $(impl Inspect for $number {
            fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
                see(place, *self as f64);
            }
        })*
    };
}

inspect_numbers!(f64 u8 u16 u32 u64 usize i32 i64);

/// What is absent meets every requirement.
impl<T: Inspect> Inspect for Option<T> {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        if let Some(value) = self {
            value.numbers(place, see);
        }
    }

    fn length(&self) -> Option<usize> {
        self.as_ref().and_then(Inspect::length)
    }

    fn text(&self) -> Option<&str> {
        self.as_ref().and_then(Inspect::text)
    }
}

impl<T: Inspect> Inspect for [T] {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        for (i, item) in self.iter().enumerate() {
            place.push(i);
            item.numbers(place, see);
            place.pop();
        }
    }

    fn length(&self) -> Option<usize> {
        Some(self.len())
    }
}

impl<T: Inspect> Inspect for Vec<T> {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        self.as_slice().numbers(place, see);
    }

    fn length(&self) -> Option<usize> {
        Some(self.len())
    }
}

impl<T: Inspect, const N: usize> Inspect for [T; N] {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        self.as_slice().numbers(place, see);
    }

    fn length(&self) -> Option<usize> {
        Some(N)
    }
}

impl Inspect for String {
    fn numbers(&self, _place: &mut Vec<usize>, _see: &mut dyn FnMut(&[usize], f64)) {}

    fn length(&self) -> Option<usize> {
        Some(self.chars().filter(|sign| !sign.is_whitespace()).count())
    }

    fn text(&self) -> Option<&str> {
        Some(self)
    }
}
