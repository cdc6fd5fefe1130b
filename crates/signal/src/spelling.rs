//! Spelling help for unknown names.

/// The known word most like `word`, if any is near enough to be meant.
///
/// Near is an edit distance (insert, delete, replace, swap neighbours; letters compared without case) of at most a
/// third of the longer word. Among equals the one with the same capitals wins, then the first.
pub fn closest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    nearest(word, known).map(|(meant, _)| meant)
}

/// The known word that is meant beyond doubt: as [`closest`], no other one is as near, and a slip of the pen makes one of the other. Words
/// that differ in a digit, such as `axis1` and `axis2`, may both be meant as they are, and so may those that differ in a letter which stands
/// for something (`r_off` and `g_off`, `mass_a` and `mass_b`) or begins a word (`Synchronous` and `Asynchronous`).
pub fn surely<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
    let (meant, is_alone) = nearest(word, known)?;
    (is_alone && digits(meant) == digits(word) && is_slip(word, meant)).then_some(meant)
}

/// Letters of a word from which one that is wrong leaves no doubt, and from which two do.
const CLEAR: usize = 4;
const LONG: usize = 8;

/// Whether two names differ in capitals and signs between words only, or in a slip within one longer word.
fn is_slip(word: &str, meant: &str) -> bool {
    let (ours, theirs) = (words(word), words(meant));
    if ours.concat() == theirs.concat() {
        return true;
    }
    let mut differ = ours.iter().zip(&theirs).filter(|(a, b)| a != b);
    let (Some((a, b)), None, true) = (differ.next(), differ.next(), ours.len() == theirs.len()) else {
        return false;
    };
    let longer = a.len().max(b.len());
    let most = if longer >= LONG { 2 } else { 1 };
    longer >= CLEAR && a.first() == b.first() && distance(a, b) <= most
}

/// The words of a name, in small letters: `joint1.maxTorque` has joint, max and torque.
fn words(name: &str) -> Vec<Vec<char>> {
    let mut all: Vec<Vec<char>> = vec![Vec::new()];
    let letters: Vec<char> = name.chars().collect();
    for (i, letter) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|before| letters[before]);
        let next = letters.get(i + 1);
        let begins = letter.is_uppercase()
            && (before.is_some_and(char::is_lowercase)
                || before.is_some_and(char::is_uppercase) && next.is_some_and(|next| next.is_lowercase()));
        if !letter.is_alphabetic() || begins {
            all.push(Vec::new());
        }
        if let (true, Some(last)) = (letter.is_alphabetic(), all.last_mut()) {
            last.extend(letter.to_lowercase());
        }
    }
    all.retain(|word| !word.is_empty());
    all
}

/// The known word most like `word`, and whether it is nearer than all others.
fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<(&'a str, bool)> {
    let exact: Vec<char> = word.chars().take(MAX_LETTERS + 1).collect();
    if exact.is_empty() || exact.len() > MAX_LETTERS {
        return None;
    }
    let folded = fold(&exact);
    let mut best: Option<((usize, usize), &str)> = None;
    let mut is_alone = true;
    for candidate in known {
        let letters: Vec<char> = candidate.chars().take(MAX_LETTERS + 1).collect();
        let longer = letters.len().max(exact.len());
        if letters.len() > MAX_LETTERS || letters.len().abs_diff(exact.len()) * 3 > longer {
            continue;
        }
        let far = distance(&folded, &fold(&letters));
        if far * 3 > longer || best.is_some_and(|(_, meant)| meant == candidate) {
            continue;
        }
        let rank = (far, distance(&exact, &letters));
        let least = best.map(|(least, _)| least);
        match least {
            Some((least, _)) if far == least => is_alone = false,
            Some((least, _)) if far > least => {}
            _ => is_alone = true,
        }
        if least.is_none_or(|least| rank < least) {
            best = Some((rank, candidate));
        }
    }
    best.map(|(_, candidate)| (candidate, is_alone))
}

/// Longer words get no help: the distance costs the product of both lengths.
const MAX_LETTERS: usize = 64;

fn fold(letters: &[char]) -> Vec<char> {
    letters.iter().flat_map(|c| c.to_lowercase()).collect()
}

/// Restricted Damerau-Levenshtein distance (optimal string alignment), three rows at a time.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replace = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replace.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = above;
        above = row;
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(text: &str) -> Vec<char> {
        text.chars().collect()
    }

    #[test]
    fn a_swap_of_neighbours_counts_once() {
        for (a, b, far) in
            [("", "abc", 3), ("kitten", "sitting", 3), ("form", "from", 1), ("same", "same", 0)]
        {
            assert_eq!(distance(&letters(a), &letters(b)), far, "{a} {b}");
            assert_eq!(distance(&letters(b), &letters(a)), far, "{b} {a}");
        }
    }

    #[test]
    fn the_nearest_word_is_found_without_regard_to_case() {
        let kinds = ["Gain", "DcMotor", "Step", "Sum"];
        assert_eq!(closest("DcMotr", kinds), Some("DcMotor"));
        assert_eq!(closest("gain", kinds), Some("Gain"));
        assert_eq!(closest("Gian", kinds), Some("Gain"));
    }

    #[test]
    fn the_same_capitals_win_among_equals() {
        assert_eq!(closest("MHz", ["mHz", "MHz"]), Some("MHz"));
    }

    #[test]
    fn a_word_is_sure_if_no_other_is_as_near_and_no_digit_differs() {
        assert_eq!(surely("Gian", ["Gain", "Step"]), Some("Gain"));
        assert_eq!(surely("lowr", ["lower", "lows"]), None, "two of them are one letter away");
        assert_eq!(surely("Mhz", ["mHz", "MHz"]), None, "capitals are letters, too");
        assert_eq!(surely("axis2", ["axis1", "gears"]), None);
        assert_eq!(surely("axs2", ["axis1", "axis2"]), Some("axis2"));
        assert_eq!(surely("Gian", ["Gain", "Gain"]), Some("Gain"), "the same word twice is one");
    }

    #[test]
    fn a_letter_that_means_something_is_no_slip() {
        for (word, known) in [
            ("r_off", "g_off"),
            ("l_ls", "x_ls"),
            ("w_rated", "f_rated"),
            ("v0", "w0"),
            ("kv", "k"),
            ("r_s", "r_r"),
            ("mass_a", "mass_b"),
            ("speed_y", "speed_x"),
            ("phase_b.y", "phase_a.y"),
            ("m.v_q", "m.i_q"),
            ("Cosine", "Sine"),
            ("Max", "Mux"),
            ("Mul", "Mux"),
            ("DCVoltageSource", "AcVoltageSource"),
            ("SynchronousMachine", "AsynchronousMachine"),
            ("SeriesMotor", "StepperMotor"),
            ("BldcMotor", "DcMotor"),
            ("OnDelay", "Delay"),
            ("FlowSensor", "FluxSensor"),
        ] {
            assert_eq!(surely(word, [known]), None, "{word}");
        }
        for (word, known) in [
            ("demnd.y", "demand.y"),
            ("aftr", "after"),
            ("DcMotr", "DcMotor"),
            ("gearratio", "gear_ratio"),
            ("r_sourse", "r_source"),
            ("INTEGRATOR", "Integrator"),
            ("DCMotor", "DcMotor"),
            ("AsynchronosMachine", "AsynchronousMachine"),
        ] {
            assert_eq!(surely(word, [known]), Some(known), "{word}");
        }
    }

    #[test]
    fn a_far_word_is_no_help() {
        assert_eq!(closest("Integrator", ["Gain", "Step"]), None);
        assert_eq!(closest("k", ["m"]), None);
        assert_eq!(closest("", ["m"]), None);
        assert_eq!(closest(&"a".repeat(100_000), ["a"]), None);
    }
}
