//! Who may ask. Each request is looked at before anything of it is used.

use crate::Token;

/// Name of the cookie, which has the port behind it: several studios of one browser do not share it, although cookies know no ports.
const COOKIE: &str = "blocksim";

/// What a request says of where it comes from.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Caller<'a> {
    /// Header `Host`.
    pub host: Option<&'a str>,
    /// Header `Origin`.
    pub origin: Option<&'a str>,
    /// Header `Sec-Fetch-Site`.
    pub site: Option<&'a str>,
    /// Header `Cookie`.
    pub cookie: Option<&'a str>,
    /// Header `X-Blocksim`, which no page of another site can set.
    pub own: Option<&'a str>,
    /// What stands behind `?token=`.
    pub token: Option<&'a str>,
}

/// What is done with a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is answered.
    Welcome,
    /// It brings the token along: the browser gets its cookie.
    First,
    /// It is not answered, for this reason.
    Refused(&'static str),
}

/// Names by which the server may be called.
fn hosts(port: u16) -> [String; 2] {
    [format!("127.0.0.1:{port}"), format!("localhost:{port}")]
}

/// Looks at a request; `acts` says whether it changes anything.
pub(crate) fn verdict(caller: &Caller, token: &Token, port: u16, acts: bool) -> Verdict {
    let hosts = hosts(port);
    if !caller.host.is_some_and(|host| hosts.iter().any(|own| own == host)) {
        return Verdict::Refused("this server answers to 127.0.0.1 alone");
    }
    let is_own = |origin: &str| hosts.iter().any(|own| origin.strip_prefix("http://") == Some(own));
    if caller.origin.is_some_and(|origin| !is_own(origin)) {
        return Verdict::Refused("requests of other pages are not answered");
    }
    let is_first = caller.token.is_some_and(|known| token.is(known));
    // A link from elsewhere may lead here, if it knows the token.
    if caller.site.is_some_and(|site| site != "same-origin" && site != "none") && !is_first {
        return Verdict::Refused("requests of other pages are not answered");
    }
    if is_first && !acts {
        return Verdict::First;
    }
    let name = format!("{COOKIE}-{port}=");
    let cookies = caller.cookie.into_iter().flat_map(|all| all.split(';'));
    let known = cookies.filter_map(|one| one.trim().strip_prefix(name.as_str())).any(|value| token.is(value));
    if !known {
        return Verdict::Refused(
            "this page is for the person who started it: open the whole address that `blocksim studio` has printed, with its token",
        );
    }
    if acts && caller.own != Some("1") {
        return Verdict::Refused("requests of other pages are not answered");
    }
    Verdict::Welcome
}

/// The header that gives a browser its cookie.
pub(crate) fn cookie(token: &Token, port: u16) -> String {
    format!("{COOKIE}-{port}={}; HttpOnly; SameSite=Strict; Path=/", token.text())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strangers_are_not_answered() {
        let token = Token::new().unwrap();
        let cookie = format!("a=b; blocksim-7700={}", token.text());
        let good = Caller {
            host: Some("127.0.0.1:7700"),
            cookie: Some(&cookie),
            own: Some("1"),
            ..Caller::default()
        };
        let look = |caller: Caller| verdict(&caller, &token, 7700, false);
        let act = |caller: Caller| verdict(&caller, &token, 7700, true);
        assert_eq!([look(good), act(good)], [Verdict::Welcome; 2]);
        assert_eq!(look(Caller { host: Some("localhost:7700"), ..good }), Verdict::Welcome);
        let first =
            Caller { cookie: None, token: Some(token.text()), own: None, site: Some("cross-site"), ..good };
        assert_eq!(look(first), Verdict::First);
        for bad in [
            Caller { host: Some("evil.example:7700"), ..good },
            Caller { host: Some("127.0.0.1:7701"), ..good },
            Caller { host: None, ..good },
            Caller { origin: Some("http://evil.example"), ..good },
            Caller { origin: Some("null"), ..good },
            Caller { site: Some("cross-site"), ..good },
            Caller { site: Some("same-site"), ..good },
            Caller { cookie: None, ..good },
            Caller { cookie: Some("blocksim-7700=0"), ..good },
            Caller { cookie: None, token: Some("0"), ..good },
        ] {
            assert!(matches!(look(bad), Verdict::Refused(_)), "{bad:?}");
            assert!(matches!(act(bad), Verdict::Refused(_)), "{bad:?}");
        }
        assert!(matches!(act(Caller { own: None, ..good }), Verdict::Refused(_)));
        assert!(matches!(act(first), Verdict::Refused(_)), "a link does nothing but open the page");
        assert!(self::cookie(&token, 7700).ends_with("; HttpOnly; SameSite=Strict; Path=/"));
    }
}
