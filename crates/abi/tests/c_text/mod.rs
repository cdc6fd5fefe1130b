//! Translates `table.rs` to C. It knows the few forms that file is written in and refuses others.

/// What `table.rs` declares, in its order.
enum Item<'a> {
    Constant { name: &'a str, value: &'a str },
    Status,
    Function { name: &'a str, arguments: Vec<(&'a str, &'a str)>, result: &'a str },
    Struct { name: &'a str, fields: Vec<(Vec<&'a str>, &'a str, &'a str)> },
}

/// The header.
pub fn header(table_rs: &str) -> String {
    let mut c = String::from("/* Generated from crates/abi/src/table.rs by the tests of that crate.\n\n");
    for line in table_rs.lines().map_while(|line| line.strip_prefix("//!")) {
        c += format!("  {line}").trim_end();
        c += "\n";
    }
    c += "*/\n#ifndef BLOCKSIM_PLUGIN_H\n#define BLOCKSIM_PLUGIN_H\n\n#include <stddef.h>\n#include <stdint.h>\n\n";
    c += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for (doc, item) in items(table_rs) {
        c += "\n";
        c += &comment("", &doc);
        c += &declaration(&item);
    }
    c += TAIL;
    c
}

const TAIL: &str = r#"
/* For authors: a constant text, the bit of input `i` in `reads`, and what makes a function visible. */
#define BLOCKSIM_TEXT(literal) {(literal), sizeof(literal) - 1}
#define BLOCKSIM_READS(i) (UINT64_C(1) << (i))
#if defined(_WIN32)
#define BLOCKSIM_EXPORT __declspec(dllexport)
#else
#define BLOCKSIM_EXPORT __attribute__((visibility("default")))
#endif

/* The plug-in defines this one. */
BLOCKSIM_EXPORT const blocksim_plugin_table *blocksim_plugin_v1(void);

#ifdef __cplusplus
}
#endif
#endif
"#;

/// A C program that prints size and offsets of every struct.
pub fn layout_program(table_rs: &str) -> String {
    let mut c = String::from("#include <stdio.h>\n#include \"blocksim_plugin.h\"\nint main(void) {\n");
    for (_, item) in items(table_rs) {
        let Item::Struct { name, fields } = item else { continue };
        let ty = c_name(name);
        c += &format!("printf(\"{name} %u\\n\", (unsigned)sizeof({ty}));\n");
        for (_, field, _) in fields {
            c += &format!("printf(\"{name}.{field} %u\\n\", (unsigned)offsetof({ty}, {field}));\n");
        }
    }
    c + "return 0; }\n"
}

/// All declarations up to the first `unsafe impl`, each with its doc lines.
fn items(table_rs: &str) -> Vec<(Vec<&str>, Item<'_>)> {
    let mut items = Vec::new();
    let mut doc = Vec::new();
    let mut lines = table_rs.lines();
    while let Some(line) = lines.next() {
        if let Some(text) = line.strip_prefix("///") {
            doc.push(text);
        } else if let Some(rest) = line.strip_prefix("pub const ") {
            let (name, rest) = rest.split_once(": ").unwrap();
            let (_, value) = rest.trim_end_matches(';').split_once(" = ").unwrap();
            items.push((std::mem::take(&mut doc), Item::Constant { name, value }));
        } else if line == "pub type Status = i32;" {
            items.push((std::mem::take(&mut doc), Item::Status));
        } else if let Some(rest) = line.strip_prefix("pub type ") {
            let (name, _) = rest.split_once(" =").unwrap();
            // One argument a line, all on one line, or the type on a line of its own: find the end first.
            let start = table_rs.find(line).unwrap();
            let text = &table_rs[start..start + table_rs[start..].find(';').unwrap()];
            let (_, signature) = text.split_once("unsafe extern \"C\" fn(").unwrap();
            let (arguments, result) = signature.rsplit_once(") -> ").unwrap();
            let arguments = arguments
                .split(',')
                .filter(|a| !a.trim().is_empty())
                .map(|a| a.trim().split_once(": ").unwrap())
                .collect();
            while !line.ends_with(';') && lines.next().is_some_and(|line| !line.ends_with(';')) {}
            items.push((std::mem::take(&mut doc), Item::Function { name, arguments, result }));
        } else if let Some(rest) = line.strip_prefix("pub struct ") {
            let name = rest.trim_end_matches(" {");
            let mut fields = Vec::new();
            let mut field_doc = Vec::new();
            for line in lines.by_ref().map(str::trim).take_while(|line| *line != "}") {
                match line.strip_prefix("///") {
                    Some(text) => field_doc.push(text),
                    None => {
                        let field = line.strip_prefix("pub ").unwrap().trim_end_matches(',');
                        let (field, ty) = field.split_once(": ").unwrap();
                        fields.push((std::mem::take(&mut field_doc), field, ty));
                    }
                }
            }
            items.push((std::mem::take(&mut doc), Item::Struct { name, fields }));
        } else if line.starts_with("unsafe impl") {
            break;
        } else {
            let harmless = ["", "#[repr(C)]", "#[derive(Clone, Copy)]", "use core::ffi::c_char;"];
            let known = harmless.contains(&line) || line.starts_with("//");
            assert!(known, "`table.rs` has a line that the header cannot show: {line}");
        }
    }
    items
}

fn declaration(item: &Item) -> String {
    match item {
        Item::Constant { name, value } => format!("#define BLOCKSIM_{name} {}\n", c_value(value)),
        Item::Status => "typedef int32_t blocksim_status;\n".to_string(),
        Item::Function { name, arguments, result } => {
            let arguments: Vec<_> = arguments.iter().map(|(name, ty)| c_variable(ty, name)).collect();
            let arguments = if arguments.is_empty() { "void".to_string() } else { arguments.join(", ") };
            let head = c_variable(result, &format!("(*{})", c_name(name)));
            wrap(&format!("typedef {head}({arguments});"))
        }
        Item::Struct { name, fields } => {
            let ty = c_name(name);
            let mut c = format!("typedef struct {ty} {{\n");
            for (doc, field, ty) in fields {
                c += &comment("    ", doc);
                c += &format!("    {};\n", c_variable(ty, field));
            }
            c + &format!("}} {ty};\n")
        }
    }
}

fn comment(indent: &str, doc: &[&str]) -> String {
    let text = doc.join(&format!("\n{indent}  "));
    format!("{indent}/*{} */\n", text.trim_end())
}

/// Breaks a long prototype behind a comma.
fn wrap(line: &str) -> String {
    let mut out = String::new();
    let mut column = 0;
    for word in line.split_inclusive(", ") {
        if column + word.len() > 100 {
            out = out.trim_end().to_string() + "\n        ";
            column = 8;
        }
        out += word;
        column += word.len();
    }
    out + "\n"
}

fn c_value(value: &str) -> String {
    match value.strip_prefix("*b\"") {
        Some(bytes) => {
            let bytes: Vec<_> = bytes.trim_end_matches('"').chars().map(|c| format!("'{c}'")).collect();
            format!("{{{}}}", bytes.join(", "))
        }
        None => value.to_string(),
    }
}

/// `ty name` as C declares it.
fn c_variable(ty: &str, name: &str) -> String {
    if let Some(to) = ty.strip_prefix("*const ") {
        return format!("const {} *{name}", c_type(to));
    }
    if let Some(to) = ty.strip_prefix("*mut ") {
        return format!("{} *{name}", c_type(to));
    }
    if let Some((element, length)) =
        ty.strip_prefix('[').and_then(|t| t.trim_end_matches(']').split_once("; "))
    {
        return format!("{} {name}[{length}]", c_type(element));
    }
    format!("{} {name}", c_type(ty))
}

fn c_type(ty: &str) -> String {
    match ty {
        "u8" => "uint8_t".to_string(),
        "u16" => "uint16_t".to_string(),
        "u32" => "uint32_t".to_string(),
        "u64" => "uint64_t".to_string(),
        "usize" => "size_t".to_string(),
        "f64" => "double".to_string(),
        "c_char" => "char".to_string(),
        _ => c_name(ty.strip_prefix("Option<").map_or(ty, |t| t.trim_end_matches('>'))),
    }
}

/// `BlockTable` is `blocksim_block_table`.
fn c_name(name: &str) -> String {
    let mut c = String::from("blocksim");
    for letter in name.chars() {
        assert!(letter.is_ascii_alphanumeric(), "`{name}` is not a type that the header knows");
        if letter.is_ascii_uppercase() {
            c.push('_');
        }
        c.push(letter.to_ascii_lowercase());
    }
    c
}
