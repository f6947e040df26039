// What a reader meets in a page: pages.py puts it into a harness beside a frame of the page, which Chromium runs without a window.
const said = [];
function tell(what, element) {
    said.push(`${what}: ${element ? `<${element.localName}${element.className ? " class=" + element.className : ""}> ` + element.textContent.trim().slice(0, 40) : ""}`);
}

function channels(colour) { // as 0..1, with alpha
    const [r, g, b, a = 1] = colour.match(/[\d.]+/g).map(Number);
    return [r / 255, g / 255, b / 255, a];
}
function luminance([r, g, b]) { // WCAG 2.1, relative luminance
    const linear = c => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4;
    return .2126 * linear(r) + .7152 * linear(g) + .0722 * linear(b);
}
function background(view, element) {
    for (; element; element = element.parentElement) {
        const colour = channels(view.getComputedStyle(element).backgroundColor);
        if (colour[3] === 1)
            return colour;
    }
    return channels(view.matchMedia("(prefers-color-scheme: dark)").matches ? "rgb(18, 18, 18)" : "rgb(255, 255, 255)");
}

// WCAG AA: 4.5, and 3 for large letters.
function check_contrast(view, page) {
    const walk = page.createTreeWalker(page.body, NodeFilter.SHOW_TEXT);
    let looked = 0;
    for (let text; (text = walk.nextNode());) {
        const element = text.parentElement, style = view.getComputedStyle(element);
        if (!text.data.trim() || !element.getClientRects().length || ["SCRIPT", "STYLE", "OPTION"].includes(element.tagName))
            continue;
        const [a, b] = [channels(style.color), background(view, element)].map(luminance).sort((x, y) => y - x);
        const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
        looked++;
        if ((a + .05) / (b + .05) < (large ? 3 : 4.5))
            tell(`contrast ${((a + .05) / (b + .05)).toFixed(2)}`, element);
    }
    if (!looked)
        tell("no text");
}

function check_widths(view, page) {
    const root = page.documentElement;
    if (root.scrollWidth > root.clientWidth)
        tell(`wider than the window: ${root.scrollWidth} of ${root.clientWidth}`);
    for (const element of page.querySelectorAll("body *")) {
        const style = view.getComputedStyle(element);
        if (style.overflowX === "hidden" && element.scrollWidth > element.clientWidth + 1 && !element.title)
            tell("cut", element);
    }
    if (root.clientWidth < 500)
        for (const row of page.querySelectorAll("tr"))
            if (row.getBoundingClientRect().height > 100)
                tell("a tall row", row);
}

function check_keys(view, page) {
    for (const element of page.querySelectorAll("a, input, select, summary")) {
        const name = element.getAttribute("aria-label") || element.textContent.trim() || element.closest("label")?.textContent.trim();
        if (element.tabIndex < 0 || !name)
            tell("no name, or out of Tab's way", element);
    }
    const press = key => page.body.dispatchEvent(new view.KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
    const stops = [...page.querySelectorAll(".stop")], frames = page.querySelectorAll(".stack").length;
    stops.forEach((stop, i) => {
        press("j");
        const top = stop.getBoundingClientRect().top;
        if (page.activeElement !== stop || top < -1 || top > view.innerHeight)
            tell(`j ${i + 1} leads elsewhere`, stop);
    });
    press(" ");
    if (page.querySelectorAll(".stack.flip").length !== frames)
        tell("space flips nothing");
    press(" ");
    if (page.querySelector(".stack.flip"))
        tell("space flips for ever");
}

// On a phone a verdict is on the screen wherever the page stands.
function check_verdict(view, page) {
    const verdict = page.querySelector(".verdict");
    view.scrollTo(0, page.documentElement.scrollHeight);
    const box = verdict?.getBoundingClientRect();
    if (verdict && view.innerWidth < 500 && page.querySelector(".tools") && (box.bottom < 0 || box.top > view.innerHeight))
        tell("the verdict is off the screen", verdict);
    view.scrollTo(0, 0);
    if (verdict && verdict.getBoundingClientRect().bottom > view.innerHeight)
        tell("the verdict is below the first screen", verdict);
}

// False colour and exposure reach the pictures.
function check_looks(view, page) {
    const switched = page.querySelector(".false-colour"), exposure = page.querySelector(".exposure");
    const filter = () => view.getComputedStyle(page.querySelector("article img")).filter;
    if (!switched)
        return;
    switched.click();
    if (!filter().includes("#false"))
        tell(`no false colour: ${filter()}`);
    switched.click();
    exposure.value = 2;
    exposure.dispatchEvent(new view.Event("input"));
    if (filter() !== "brightness(4)")
        tell(`exposure: ${filter()}`);
}

addEventListener("load", () => {
    for (const frame of document.querySelectorAll("iframe")) {
        const view = frame.contentWindow, before = said.length;
        for (const check of [check_widths, check_contrast, check_keys, check_verdict, check_looks])
            check(view, view.document);
        said.splice(before, said.length, ...said.slice(before).map(text => `${frame.name}: ${text}`));
    }
    const list = document.createElement("pre");
    list.id = "said";
    list.textContent = ["looked at", ...said].join("\n");
    document.body.replaceChildren(list);
});
