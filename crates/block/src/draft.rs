//! From written parameters to a block, whatever its kind.

use blocksim_signal::Unit;
use serde::{Deserialize, Deserializer};

use crate::parameters::{Missing, read_parameters};
use crate::reading::{ReadError, Values};
use crate::requirements::{Inspect, check};
use crate::{Block, ParamErrors, ParameterInfo, Parameters, Registered};

/// A kind of block: parameters that become a block. `#[derive(BlockMeta)]` implements it.
pub trait BlockKind: Parameters {
    /// What runs: the struct of the parameters itself, or what `#[block(builds = ...)]` names.
    type Block: Block;

    /// The block. Called where the parameters have no errors.
    fn into_block(self, errors: &mut ParamErrors) -> Option<Self::Block>;

    /// The block of parameters that make sense.
    ///
    /// # Panics
    /// They make none: this is a tool of tests.
    fn built(self) -> Self::Block {
        self.try_build().unwrap_or_else(|errors| panic!("parameters that make sense: {errors:?}"))
    }

    /// The block, or all that is wrong with the parameters.
    ///
    /// # Errors
    /// Requirements of declarations that are not met, what `validate` finds, or, where that is nothing, what keeps the block from being
    /// built.
    fn try_build(self) -> Result<Self::Block, ParamErrors> {
        let mut errors = self.errors();
        if !errors.is_empty() {
            return Err(errors);
        }
        let block = self.into_block(&mut errors);
        block.filter(|_| errors.is_empty()).ok_or(errors)
    }
}

/// Parameters of a kind as far as they were read, with its type erased.
pub trait Fields {
    /// What is known of them.
    fn infos(&self) -> &'static [ParameterInfo];

    /// Those that could not be read.
    fn unread(&self) -> ParamErrors;

    /// As [`Parameters::complete`].
    fn complete(&mut self, errors: &ParamErrors);

    /// As [`Parameters::value_read`].
    fn value(&self, index: usize) -> Option<&dyn Inspect>;

    /// The block, as far as it can be built.
    ///
    /// # Errors
    /// A parameter is missing.
    fn finish(self: Box<Self>, errors: &mut ParamErrors) -> Result<Option<Box<dyn Block>>, Missing>;
}

/// The fields of a kind.
#[derive(Debug)]
pub struct FieldsOf<K: BlockKind> {
    read: K::Read,
    unread: ParamErrors,
}

impl<K: BlockKind> FieldsOf<K> {
    /// Reads parameters by name, each of which may be wrong without hiding what is wrong with others.
    ///
    /// # Errors
    /// A parameter is unknown, or the first that is wrong, where whoever gives the values has not noted that with its place.
    pub fn read<'de, D: Deserializer<'de>>(kind: &'static str, deserializer: D) -> Result<Self, D::Error> {
        let mut read = K::Read::default();
        let take = &mut |index, values: &mut dyn Values<'de>| K::read(&mut read, index, values);
        let unread = read_noted(kind, K::NAMES, take, deserializer)?;
        Ok(Self { read, unread })
    }
}

/// Reads parameters of these names; those that are wrong, and noted as such, are the result.
fn read_noted<'de, D: Deserializer<'de>>(
    kind: &'static str,
    names: &'static [&'static str],
    take: &mut dyn FnMut(usize, &mut dyn Values<'de>) -> Result<(), ReadError>,
    deserializer: D,
) -> Result<ParamErrors, D::Error> {
    let mut unread = ParamErrors::default();
    let noting = &mut |index: usize, values: &mut dyn Values<'de>| match take(index, values) {
        Err(error) if error.is_noted() => {
            unread.unread(names[index]);
            Ok(())
        }
        result => result,
    };
    read_parameters(kind, names, noting, deserializer)?;
    Ok(unread)
}

impl<K: BlockKind> Fields for FieldsOf<K> {
    fn infos(&self) -> &'static [ParameterInfo] {
        K::INFOS
    }

    fn unread(&self) -> ParamErrors {
        self.unread.clone()
    }

    fn complete(&mut self, errors: &ParamErrors) {
        K::complete(&mut self.read, errors);
    }

    fn value(&self, index: usize) -> Option<&dyn Inspect> {
        K::value_read(&self.read, index)
    }

    fn finish(self: Box<Self>, errors: &mut ParamErrors) -> Result<Option<Box<dyn Block>>, Missing> {
        let kind = K::whole(self.read)?;
        kind.validate_all(errors);
        if !errors.is_empty() {
            return Ok(None);
        }
        Ok(kind.into_block(errors).map(|block| Box::new(block) as Box<dyn Block>))
    }
}

/// A block as it is read: `Kind(parameters)`, found in the registry of kinds.
pub struct Draft(Box<dyn Fields>);

impl<'de> Deserialize<'de> for Draft {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self(Box::<dyn Registered>::deserialize(deserializer)?.fields()))
    }
}

impl Draft {
    /// The block with defaults for what was not given, if it can be built, and all that is wrong with the parameters beside what
    /// was noted while they were read. One that is missing is not among that. `written` is the unit in which a parameter is written, if
    /// there is one: messages show its value in that.
    pub fn finish(self, written: &dyn Fn(&str) -> Option<Unit>) -> (Option<Box<dyn Block>>, ParamErrors) {
        let Self(mut fields) = self;
        let mut errors = fields.unread();
        fields.complete(&errors);
        check(fields.infos(), &|index| fields.value(index), written, &mut errors);
        errors.settle();
        let block = fields.finish(&mut errors);
        (block.ok().flatten(), errors)
    }
}
