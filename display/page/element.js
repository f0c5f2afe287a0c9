// Elements of the page from a few words, and text that is written only when it changes.

/**
 * An element with attributes and children; `onclick` and the like are listeners.
 * @returns {HTMLElement}
 */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== undefined && value !== null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export function setText(of, text) {
  if (of.textContent !== text) of.textContent = text;
}

const SVG = "http://www.w3.org/2000/svg";

/** An element of a drawing. */
export function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** A small drawing in the colour of the text, in a square of 16. */
export function drawing(path) {
  return svg("svg", { class: "icon", viewBox: "0 0 16 16", "aria-hidden": "true" }, svg("path", { d: path }));
}

export const byId = (id) => document.getElementById(id);

/**
 * A table whose rows stay in place while their numbers change.
 * `rows` is a list of `[key, cells]`; a cell is text or `{text, data, kind}`; `data` names it for tests.
 */
export class Table {
  constructor(caption, heads) {
    this.heads = heads;
    this.body = element("tbody");
    const head = element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)));
    this.table = element("table", {}, element("caption", { class: "unseen" }, caption), element("thead", {}, head), this.body);
    this.rows = new Map();
  }

  update(rows) {
    const wanted = new Set(rows.map(([key]) => key));
    for (const [key, row] of this.rows) {
      if (wanted.has(key)) continue;
      row.remove();
      this.rows.delete(key);
    }
    for (const [key, cells] of rows) {
      let row = this.rows.get(key);
      if (!row) {
        row = element("tr", {}, ...cells.map((_, i) => (i === 0 ? element("th", { scope: "row" }) : element("td"))));
        this.rows.set(key, row);
        this.body.append(row);
      }
      cells.forEach((cell, i) => {
        const of = row.children[i];
        if (cell instanceof HTMLElement) {
          if (of.firstChild !== cell) of.replaceChildren(cell);
          return;
        }
        const { text, data, kind } = typeof cell === "object" ? cell : { text: cell };
        setText(of, text);
        if (data) of.dataset.status = data;
        of.className = kind ?? "";
      });
    }
  }
}
