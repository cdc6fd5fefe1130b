//! Files that are no workbooks, or hostile ones: an error or a result, never a panic, a hang or a flood of memory.

use blocksim_params::{Arrangement, compare, open_workbook, pack, quantities, unpack};

const SET: &str = "(general: (mass: (value: \"12 kg\", source: \"scale\"), com: [\"1 mm\", \"2 mm\", \"3 mm\"]),
    axis1: (limits: (lower: \"-10 deg\", speed: \"1 deg/s\"), gear: (ring_teeth: 51)), axis2: (limits: (lower: \"-20 deg\")))";

fn book() -> Vec<u8> {
    let found = quantities(SET).expect("a set");
    blocksim_params::export(&[SET], "set.ron", &found, &Arrangement::by_group(&found)).expect("a workbook")
}

fn refused(bytes: &[u8]) -> String {
    open_workbook(bytes).expect_err("no workbook").message
}

#[test]
fn what_is_no_workbook_is_refused_with_what_it_is() {
    assert!(refused(b"").contains("not an .xlsx"));
    assert!(refused(b"(a: 1)").contains("not an .xlsx"));
    assert!(
        refused(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1 the rest").contains("old `.xls`, or it has a password")
    );
    assert!(refused(&pack(&[("content.xml".into(), "<a/>")]).expect("an archive")).contains(".ods"));
    assert!(
        refused(&pack(&[("xl/workbook.bin".into(), String::new())]).expect("an archive")).contains(".xlsb")
    );
    assert!(
        refused(&pack(&[("a".into(), String::new())]).expect("an archive"))
            .contains("`xl/workbook.xml` is missing")
    );
}

#[test]
fn every_cut_of_a_workbook_is_refused() {
    let bytes = book();
    for end in 0..bytes.len() {
        assert!(open_workbook(&bytes[..end]).is_err(), "cut at {end}");
    }
}

/// The workbook with the rows of its second sheet replaced.
fn with_rows(rows: &str) -> Vec<u8> {
    let mut parts = unpack(&book()).expect("parts");
    let (_, text) = parts.iter_mut().find(|(name, _)| name == "xl/worksheets/sheet2.xml").expect("a sheet");
    *text = format!("<worksheet><sheetData>{rows}</sheetData></worksheet>");
    pack(&parts).expect("an archive")
}

#[test]
fn a_million_rows_and_a_bomb_are_refused_at_limits() {
    let rows: String = (1..=1_000_000).map(|n| format!("<row><c><v>{n}</v></c></row>")).collect();
    assert!(refused(&with_rows(&rows)).contains("more than 100000 cells"));
    let bomb = with_rows(&" ".repeat(60 << 20));
    assert!(bomb.len() < 1 << 20);
    assert!(refused(&bomb).contains("more than 48 MiB"));
}

#[test]
fn a_million_empty_rows_and_a_cell_in_the_last_corner_are_no_harm() {
    let rows: String = (1..=1_000_000).map(|n| format!("<row r=\"{n}\"/>")).collect();
    let tables = open_workbook(&with_rows(&format!(
        "{rows}<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>"
    )));
    assert!(tables.is_ok());
}

#[test]
fn entities_that_a_document_declares_are_not_expanded() {
    let mut parts = unpack(&book()).expect("parts");
    let (_, text) = parts.iter_mut().find(|(name, _)| name == "xl/workbook.xml").expect("a part");
    *text = "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]><workbook>&b;</workbook>".to_owned();
    let tables = open_workbook(&pack(&parts).expect("an archive")).expect("a workbook without sheets");
    assert_eq!((tables.readings.len(), tables.faults.len()), (0, 1), "no sheet has keys");
}

/// Marsaglia's xorshift: the same numbers in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }
}

/// Reads and compares as far as it goes; whether it is a workbook.
fn survives(bytes: &[u8]) -> bool {
    let Ok(tables) = open_workbook(bytes) else { return false };
    let set = quantities(SET).expect("a set");
    let found = compare(&tables, &[SET], &set);
    // Text that was changed is a text of a set again.
    let _ = blocksim_params::edited(&[SET], &set, &found.edits)
        .map(|texts| quantities(&texts.concat()).expect("still a set"));
    true
}

#[test]
fn three_thousand_files_with_changed_bytes_give_an_error_or_a_result() {
    let (bytes, mut random, mut read) = (book(), Random(0x9E37_79B9_7F4A_7C15), 0);
    for _ in 0..3000 {
        let mut bytes = bytes.clone();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            match random.below(4) {
                0 => bytes[at] ^= 1 << random.below(8),
                1 => bytes[at] = [0, 0xff, b'<', b'P'][random.below(4)],
                2 => drop(bytes.drain(at..(at + 1 + random.below(30)).min(bytes.len()))),
                _ => bytes.insert(at, random.below(256) as u8),
            }
        }
        read += usize::from(survives(&bytes));
    }
    assert!(read > 0 && read < 3000, "{read} of them could be read");
}

#[test]
fn three_thousand_workbooks_with_changed_xml_give_an_error_or_a_result() {
    let parts = unpack(&book()).expect("parts");
    let (mut random, mut read) = (Random(42), 0);
    const PIECES: [&str; 12] = [
        "<",
        ">",
        "\"",
        "&#x0;",
        "&amp;",
        "</c>",
        "<c r=\"ZZZ9\">",
        "-1",
        "99999999999",
        "t=\"s\"",
        "1e999",
        "<v>",
    ];
    for _ in 0..3000 {
        let mut parts = parts.clone();
        let which = random.below(parts.len());
        let text = &mut parts[which].1;
        for _ in 0..=random.below(3) {
            let mut at = random.below(text.len());
            at -= (0..4).find(|back| text.is_char_boundary(at - back)).unwrap_or(0);
            if random.below(2) == 0 {
                text.insert_str(at, PIECES[random.below(PIECES.len())]);
            } else {
                let end = (at..text.len()).skip(1 + random.below(20)).find(|end| text.is_char_boundary(*end));
                text.replace_range(at..end.unwrap_or(text.len()), PIECES[random.below(PIECES.len())]);
            }
        }
        read += usize::from(survives(&pack(&parts).expect("an archive")));
    }
    assert!(read > 300, "many can be read: {read}");
}
