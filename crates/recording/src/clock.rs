//! Wall-clock time in UTC as text.

use std::time::{SystemTime, UNIX_EPOCH};

/// ISO 8601 with seconds: `2026-11-21T14:03:22Z`.
pub fn iso(time: SystemTime) -> String {
    let (year, month, day, hour, minute, second) = civil(seconds_since_1970(time));
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// The same for file names, which on some systems may not have colons: `2026-11-21T14-03-22`.
pub fn iso_for_file_names(time: SystemTime) -> String {
    iso(time).replace(':', "-").trim_end_matches('Z').to_owned()
}

fn seconds_since_1970(time: SystemTime) -> i64 {
    match time.duration_since(UNIX_EPOCH) {
        Ok(after) => i64::try_from(after.as_secs()).unwrap_or(i64::MAX),
        Err(before) => {
            let before = before.duration();
            -i64::try_from(before.as_secs()).unwrap_or(i64::MAX) - i64::from(before.subsec_nanos() > 0)
        }
    }
}

/// Year, month, day, hour, minute, second in the Gregorian calendar.
///
/// Counts days from 1 March of year 0, so that the leap day is the last of its year and the months before it
/// have the repeating lengths 31 30 31 30 31; 146097 days are 400 years.
fn civil(seconds: i64) -> (i64, i64, i64, i64, i64, i64) {
    const DAYS_FROM_MARCH_0_TO_1970: i64 = 719_468;
    let (days, rest) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let days = days + DAYS_FROM_MARCH_0_TO_1970;
    let (era, day_of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let leap_days = day_of_era / 1460 - day_of_era / 36_524 + day_of_era / 146_096;
    let year_of_era = (day_of_era - leap_days) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = 400 * era + year_of_era + i64::from(month <= 2);
    (year, month, day, rest / 3600, rest / 60 % 60, rest % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn known_instants_have_their_dates() {
        // From `date -u -d @N`.
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_709_251_199, "2024-02-29T23:59:59Z"),
            (1_795_269_802, "2026-11-21T14:03:22Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(iso(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
        assert_eq!(iso(UNIX_EPOCH - Duration::from_millis(1)), "1969-12-31T23:59:59Z");
        assert_eq!(
            iso_for_file_names(UNIX_EPOCH + Duration::from_secs(1_795_269_802)),
            "2026-11-21T14-03-22"
        );
    }

    #[test]
    fn every_day_of_four_centuries_follows_the_one_before() {
        let leap = |y: i64| (y % 4 == 0 && y % 100 != 0) || y % 400 == 0;
        let (mut year, mut month, mut day) = (1970, 1, 1);
        for n in 0..146_097 {
            let found = civil(n * 86_400);
            assert_eq!((found.0, found.1, found.2), (year, month, day));
            let length = match month {
                2 => 28 + i64::from(leap(year)),
                4 | 6 | 9 | 11 => 30,
                _ => 31,
            };
            day += 1;
            if day > length {
                (day, month) = (1, month + 1);
            }
            if month > 12 {
                (month, year) = (1, year + 1);
            }
        }
    }
}
