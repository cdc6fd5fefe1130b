//! The table of a plug-in as it lies in the memory of a module, where addresses and lengths have four bytes. It is copied into the
//! structs that a library of this process would have, and then held to the same rules.
//!
//! Every address comes from a stranger. What lies outside of the memory is refused here, and so is a table that describes more than
//! any plug-in needs, such as a long text that a thousand rows share.

use blocksim_abi::{BlockTable, PluginTable, Quantity, Text};

use crate::table::{MOST_ELEMENTS, MOST_NUMBERS};

/// Most bytes that texts, rows and defaults may have in all.
const MOST_BYTES: usize = 8 << 20;
/// Most rows in all. Names of a list are compared one with each other, so that the rows count more than their bytes.
const MOST_ROWS: usize = 1 << 15;

/// Where the fields of each struct are, in bytes: the layout of C for this target.
mod at {
    pub mod plugin {
        pub const ABI_MAJOR: usize = 4;
        pub const ABI_MINOR: usize = 6;
        pub const MAGIC: usize = 8;
        pub const NAME: usize = 16;
        pub const VERSION: usize = 24;
        pub const BLOCKS: usize = 32;
        pub const BLOCK_COUNT: usize = 36;
        pub const SIZE: usize = 44;
        pub const ALIGN: usize = 4;
    }
    pub mod block {
        /// Of five lists: parameters, inputs, outputs, continuous and discrete states.
        pub const COUNTS: usize = 4;
        pub const KIND: usize = 24;
        pub const DOC: usize = 32;
        /// Of the same lists.
        pub const LISTS: usize = 40;
        pub const FUNCTIONS: usize = 60;
        pub const SIZE: usize = 84;
        pub const ALIGN: usize = 4;
    }
    pub mod quantity {
        pub const LENGTH: usize = 4;
        pub const NAME: usize = 8;
        pub const UNIT: usize = 16;
        pub const DOC: usize = 24;
        pub const DEFAULT: usize = 32;
        pub const READS: usize = 40;
        pub const SIZE: usize = 48;
        pub const ALIGN: usize = 8;
    }
}

/// Bytes of the struct `message`: its size, the capacity, the address of the text.
pub const MESSAGE_SIZE: usize = 12;

/// Indices of the functions of a block, in the order of [`Op`](crate::isolate::Op), or 0 for a function that the block does not have.
pub type Indices = [u32; 6];

/// A table with all that it points to.
pub struct Translated {
    /// The table, as a library would export it; NULL where the module gave NULL. Its functions are all absent.
    pub table: *const PluginTable,
    /// The functions of each block, as indices into the table of functions of the module.
    pub functions: Vec<Indices>,
    /// What the pointers lead to.
    parts: Parts,
}

#[derive(Default)]
struct Parts {
    table: Option<Box<PluginTable>>,
    blocks: Vec<BlockTable>,
    lists: Vec<Vec<Quantity>>,
    texts: Vec<Box<[u8]>>,
    numbers: Vec<Box<[f64]>>,
}

impl Translated {
    /// Keeps all parts for the life of the process, as those of a library are.
    pub fn keep(self) -> Vec<Indices> {
        Box::leak(Box::new(self.parts));
        self.functions
    }
}

/// Translates the table at an address.
///
/// # Errors
/// What of it lies outside of the memory, or is too much.
pub fn translate(memory: &[u8], address: u32) -> Result<Translated, String> {
    let mut translation = Translation { memory, bytes: 0, rows: 0, parts: Parts::default() };
    let functions = translation.plugin(address)?;
    let parts = translation.parts;
    let table = parts.table.as_deref().map_or(std::ptr::null(), std::ptr::from_ref);
    Ok(Translated { table, functions, parts })
}

/// As many bytes of a struct as both sides know; what its author did not know is zero.
#[derive(Debug, Clone, Copy)]
struct Row<'m> {
    bytes: &'m [u8],
}

impl Row<'_> {
    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        self.bytes.get(at..at + N).and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N])
    }

    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.array(at))
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.array(at))
    }

    fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.array(at))
    }
}

struct Translation<'m> {
    memory: &'m [u8],
    bytes: usize,
    rows: usize,
    parts: Parts,
}

impl<'m> Translation<'m> {
    fn plugin(&mut self, address: u32) -> Result<Vec<Indices>, String> {
        use at::plugin as at;
        if address == 0 {
            return Ok(Vec::new());
        }
        let mut table = PluginTable {
            size: 0,
            abi_major: 0,
            abi_minor: 0,
            magic: [0; 8],
            name: Text::EMPTY,
            version: Text::EMPTY,
            blocks: std::ptr::null(),
            block_count: 0,
            reserved: 0,
        };
        let mut functions = Vec::new();
        if let Some(row) = self.row(address, at::SIZE, at::ALIGN)? {
            table.size = size_of::<PluginTable>() as u32;
            (table.abi_major, table.abi_minor) = (row.u16(at::ABI_MAJOR), row.u16(at::ABI_MINOR));
            table.magic = row.array(at::MAGIC);
            // Of something else, or of another version, nothing more is known.
            if table.magic == blocksim_abi::MAGIC && table.abi_major == blocksim_abi::ABI_MAJOR {
                table.name = self.text(&row, at::NAME)?;
                table.version = self.text(&row, at::VERSION)?;
                table.block_count = row.u32(at::BLOCK_COUNT);
                functions = self.blocks(row.u32(at::BLOCKS), table.block_count)?;
                if !functions.is_empty() {
                    table.blocks = self.parts.blocks.as_ptr();
                }
            }
        }
        self.parts.table = Some(Box::new(table));
        Ok(functions)
    }

    fn blocks(&mut self, first: u32, count: u32) -> Result<Vec<Indices>, String> {
        use at::block as at;
        let (mut blocks, mut functions) = (Vec::new(), Vec::new());
        for row in self.list(first, count, at::SIZE, at::ALIGN)? {
            let counts: [u32; 5] = std::array::from_fn(|i| row.map_or(0, |row| row.u32(at::COUNTS + 4 * i)));
            let mut lists = [std::ptr::null::<Quantity>(); 5];
            let (mut kind, mut doc) = (Text::EMPTY, Text::EMPTY);
            if let Some(row) = row {
                (kind, doc) = (self.text(&row, at::KIND)?, self.text(&row, at::DOC)?);
                for (i, list) in lists.iter_mut().enumerate() {
                    *list = self.quantities(row.u32(at::LISTS + 4 * i), counts[i])?;
                }
            }
            blocks.push(BlockTable {
                size: if row.is_some() { size_of::<BlockTable>() as u32 } else { 0 },
                parameter_count: counts[0],
                input_count: counts[1],
                output_count: counts[2],
                continuous_count: counts[3],
                discrete_count: counts[4],
                kind,
                doc,
                parameters: lists[0],
                input_ports: lists[1],
                output_ports: lists[2],
                continuous_states: lists[3],
                discrete_states: lists[4],
                check: None,
                sample_time: None,
                reset: None,
                outputs: None,
                update: None,
                derivatives: None,
            });
            functions.push(std::array::from_fn(|i| row.map_or(0, |row| row.u32(at::FUNCTIONS + 4 * i))));
        }
        self.parts.blocks = blocks;
        Ok(functions)
    }

    fn quantities(&mut self, first: u32, count: u32) -> Result<*const Quantity, String> {
        use at::quantity as at;
        let mut list = Vec::new();
        for row in self.list(first, count, at::SIZE, at::ALIGN)? {
            let mut quantity = Quantity {
                size: 0,
                length: 0,
                name: Text::EMPTY,
                unit: Text::EMPTY,
                doc: Text::EMPTY,
                default_value: std::ptr::null(),
                reads: 0,
            };
            if let Some(row) = row {
                quantity.size = size_of::<Quantity>() as u32;
                quantity.length = row.u32(at::LENGTH);
                quantity.name = self.text(&row, at::NAME)?;
                quantity.unit = self.text(&row, at::UNIT)?;
                quantity.doc = self.text(&row, at::DOC)?;
                quantity.default_value = self.numbers(row.u32(at::DEFAULT), quantity.length)?;
                quantity.reads = row.u64(at::READS);
            }
            list.push(quantity);
        }
        if list.is_empty() {
            return Ok(std::ptr::null());
        }
        // A list is not changed any more, so it stays where it is.
        let first = list.as_ptr();
        self.parts.lists.push(list);
        Ok(first)
    }

    /// The structs of an array; `None` for one whose size no version has. Nothing of an array that is NULL or too long, which is
    /// reported by those who read the count.
    fn list(
        &mut self,
        first: u32,
        count: u32,
        size: usize,
        align: usize,
    ) -> Result<Vec<Option<Row<'m>>>, String> {
        if first == 0 || count == 0 || count > MOST_ELEMENTS {
            return Ok(Vec::new());
        }
        self.rows += count as usize;
        if self.rows > MOST_ROWS {
            return Err(format!("its lists have more than {MOST_ROWS} rows"));
        }
        let Some(known) = self.row(first, size, align)? else { return Ok(vec![None; count as usize]) };
        let distance = known.u32(0);
        let mut rows = Vec::new();
        for i in 0..count {
            let address = u64::from(first) + u64::from(i) * u64::from(distance);
            let address =
                u32::try_from(address).map_err(|_| outside(address, u64::from(distance), self.memory))?;
            rows.push(self.row(address, size, align)?);
        }
        Ok(rows)
    }

    /// A struct, at most `size` bytes of it; `None` if it has a size that no version has.
    fn row(&mut self, address: u32, size: usize, align: usize) -> Result<Option<Row<'m>>, String> {
        let head = self.slice(address, 4)?;
        let own = Row { bytes: head }.u32(0) as usize;
        if own < size || !own.is_multiple_of(align) || !(address as usize).is_multiple_of(align) {
            return Ok(None);
        }
        Ok(Some(Row { bytes: self.slice(address, size)? }))
    }

    fn text(&mut self, row: &Row, at: usize) -> Result<Text, String> {
        let (address, length) = (row.u32(at), row.u32(at + 4) as usize);
        if length == 0 {
            return Ok(Text::EMPTY);
        }
        if address == 0 {
            return Ok(Text { data: std::ptr::null(), length });
        }
        let text: Box<[u8]> = self.slice(address, length)?.into();
        let data = text.as_ptr().cast();
        self.parts.texts.push(text);
        Ok(Text { data, length })
    }

    fn numbers(&mut self, address: u32, count: u32) -> Result<*const f64, String> {
        // A wrong count is reported by those who read it.
        if address == 0 || count == 0 || count as usize > MOST_NUMBERS {
            return Ok(std::ptr::null());
        }
        let (words, _) = self.slice(address, 8 * count as usize)?.as_chunks::<8>();
        let numbers: Box<[f64]> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        let first = numbers.as_ptr();
        self.parts.numbers.push(numbers);
        Ok(first)
    }

    fn slice(&mut self, address: u32, length: usize) -> Result<&'m [u8], String> {
        self.bytes += length;
        if self.bytes > MOST_BYTES {
            return Err(format!("its table describes more than {} MB", MOST_BYTES >> 20));
        }
        let begin = address as usize;
        let memory = self.memory;
        let found = begin.checked_add(length).and_then(|end| memory.get(begin..end));
        found.ok_or_else(|| outside(u64::from(address), length as u64, memory))
    }
}

fn outside(address: u64, length: u64, memory: &[u8]) -> String {
    format!(
        "its table leads to {length} bytes at address {address}, but its memory has {} bytes",
        memory.len()
    )
}
