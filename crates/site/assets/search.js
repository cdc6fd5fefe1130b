// Search in the index of the site, and the choice between light and dark. Nothing is asked for but the index beside this file.
"use strict";
(() => {
    const top = document.currentScript.dataset.top;
    const root = document.documentElement;
    const field = document.getElementById("find");
    const list = document.getElementById("found");
    const button = document.getElementById("theme");

    // Pages that are opened from the disk may have no memory.
    const memory = (() => {
        try {
            return window.localStorage;
        } catch {
            return null;
        }
    })();
    const kept = memory?.getItem("theme");
    if (kept === "light" || kept === "dark") root.dataset.theme = kept;
    button.disabled = false;
    button.addEventListener("click", () => {
        const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
        root.dataset.theme = dark ? "light" : "dark";
        memory?.setItem("theme", root.dataset.theme);
    });

    // On a wide screen the list of pages is always there.
    const menu = document.querySelector("details.menu");
    const wide = matchMedia("(min-width: 800px)");
    const unfold = () => (menu.open = wide.matches);
    wide.addEventListener("change", unfold);
    unfold();
    const here = document.querySelector("[aria-current=page]");
    if (wide.matches && here) here.scrollIntoView({ block: "nearest" });

    let entries = null;
    let loading = null;
    const load = () =>
        (loading ??= new Promise((resolve) => {
            const script = document.createElement("script");
            script.src = `${top}search-index.js`;
            script.onload = () => {
                entries = window.manualIndex.map(([page, heading, address, text, group]) => ({
                    page, heading, address, text, group,
                    low: [page, heading, text].map((part) => part.toLowerCase()),
                }));
                resolve();
            };
            document.head.append(script);
        }));

    // A name counts more than a heading, a heading more than a text, the beginning of a word more than its middle.
    const score = (entry, words) => {
        let sum = 0;
        for (const word of words) {
            let best = 0;
            // Sections of a page do not crowd out other pages.
            (entry.heading ? [4, 20, 2] : [30, 20, 2]).forEach((weight, n) => {
                const at = entry.low[n].indexOf(word);
                if (at < 0) return;
                const starts = at === 0 || !/[\p{L}\p{N}]/u.test(entry.low[n][at - 1]);
                const whole = entry.low[n] === word;
                best = Math.max(best, weight * (whole ? 4 : starts ? 2 : 1));
            });
            if (best === 0) return 0;
            sum += best;
        }
        return entry.heading ? sum : sum + 1;
    };

    let chosen = -1;
    const show = () => {
        const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
        list.replaceChildren();
        chosen = -1;
        if (!entries || words.length === 0) {
            list.hidden = true;
            return;
        }
        const found = entries.map((entry) => [score(entry, words), entry]).filter(([points]) => points > 0);
        found.sort((a, b) => b[0] - a[0]);
        for (const [, entry] of found.slice(0, 12)) {
            const item = document.createElement("li");
            const link = document.createElement("a");
            link.href = top + entry.address;
            link.textContent = entry.heading ? `${entry.page}: ${entry.heading}` : entry.page;
            const about = document.createElement("small");
            const at = Math.max(0, entry.low[2].indexOf(words[0]) - 30);
            about.textContent = `${entry.group} · ${at > 0 ? "… " : ""}${entry.text.slice(at, at + 110)}`;
            link.append(about);
            item.append(link);
            list.append(item);
        }
        if (found.length === 0) {
            const item = document.createElement("li");
            item.className = "none";
            item.textContent = "Nothing found";
            list.append(item);
        }
        list.hidden = false;
    };
    field.disabled = false;
    field.addEventListener("focus", load);
    field.addEventListener("input", () => load().then(show));
    field.addEventListener("keydown", (event) => {
        const links = [...list.querySelectorAll("a")];
        if (event.key === "Escape") {
            field.value = "";
            show();
        } else if (event.key === "Enter") {
            (links[chosen] ?? links[0])?.click();
        } else if ((event.key === "ArrowDown" || event.key === "ArrowUp") && links.length) {
            event.preventDefault();
            chosen = (chosen + (event.key === "ArrowDown" ? 1 : -1) + links.length) % links.length;
            links.forEach((link, n) => link.classList.toggle("chosen", n === chosen));
            links[chosen].scrollIntoView({ block: "nearest" });
        }
    });
    document.addEventListener("click", (event) => {
        if (!event.target.closest(".find")) list.hidden = true;
    });
    document.addEventListener("keydown", (event) => {
        if (event.key === "/" && !/^(INPUT|TEXTAREA)$/.test(document.activeElement.tagName)) {
            event.preventDefault();
            field.focus();
        }
    });
})();
