//! Elements whose current follows from a voltage by a law of their own, and names for the elements of a part.

/// The name of an element within its part. Whoever writes a part reads and gives values by it, so that an element added before
/// another moves nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Handle(&'static str);

impl Handle {
    /// A name that no other element of the part has.
    pub const fn new(name: &'static str) -> Self {
        Self(name)
    }

    /// The name.
    pub fn name(self) -> &'static str {
        self.0
    }
}

/// Where the values of a named element lie among those of its part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementPlace {
    /// The name of the element.
    pub handle: Handle,
    /// Its first two-pin, as [`Flowing`](super::Flowing) counts them.
    pub two_pin: usize,
    /// Its number among the characteristics of the part, if it is one.
    pub characteristic: Option<usize>,
}

/// Where an element lies that is called so.
pub(super) fn find(places: &[ElementPlace], handle: Handle) -> Option<&ElementPlace> {
    places.iter().find(|place| place.handle == handle)
}

/// The characteristics of a part at certain voltages: what [`Component::characteristics`](super::Component::characteristics)
/// reads and fills.
#[derive(Debug)]
pub struct Characteristics<'a> {
    places: &'a [ElementPlace],
    voltage: &'a [f64],
    current: &'a mut [f64],
    slope: &'a mut [f64],
}

impl<'a> Characteristics<'a> {
    /// All currents and slopes zero. `voltage` and `current` have one entry for each characteristic, `slope` as many
    /// squared, by rows of currents.
    pub fn new(
        places: &'a [ElementPlace],
        voltage: &'a [f64],
        current: &'a mut [f64],
        slope: &'a mut [f64],
    ) -> Self {
        current.fill(0.0);
        slope.fill(0.0);
        Self { places, voltage, current, slope }
    }

    fn place(&self, handle: Handle) -> Option<usize> {
        let place = find(self.places, handle).and_then(|place| place.characteristic);
        assert!(place.is_some(), "the part has no characteristic `{}`", handle.name());
        place
    }

    /// Voltage from `p` to `n`, V; the across quantity in other domains. Not a number if the part has no such characteristic.
    #[inline]
    pub fn voltage(&self, handle: Handle) -> f64 {
        self.place(handle).map_or(f64::NAN, |k| self.voltage[k])
    }

    /// Gives the current from `p` to `n`, A; the through quantity in other domains.
    #[inline]
    pub fn current(&mut self, handle: Handle, current: f64) {
        if let Some(k) = self.place(handle) {
            self.current[k] = current;
        }
    }

    /// Gives the exact slope of the current of one characteristic over the voltage of another one, or the same, S.
    #[inline]
    pub fn slope(&mut self, of: Handle, over: Handle, slope: f64) {
        if let (Some(row), Some(column)) = (self.place(of), self.place(over)) {
            self.slope[row * self.voltage.len() + column] = slope;
        }
    }
}
