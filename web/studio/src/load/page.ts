// What the load page shows: how busy the gateway and its server are. It asks for numbers and runs nothing.
import { button, choice, h, write } from "../ui/dom.js";
import { themeField } from "../ui/theme.js";
import { words } from "../words.js";
import type { Load } from "./answer.js";
import { ChartView } from "./chart.js";
import { charts } from "./measures.js";
import { Watch } from "./watch.js";
import type { Moment } from "./watch.js";

const { load: text } = words;
const admin = "--arapd-admin http://127.0.0.1:PORT";

export class LoadPage {
  readonly element: HTMLElement;
  readonly watch: Watch;
  readonly #views = charts.map((chart) => new ChartView(chart));
  readonly #state = h("strong", { role: "status", "data-state": "" });
  readonly #facts = h("p", { class: "facts" });
  readonly #hint = h("p", { class: "hint", hidden: true }, text.hiddenHint(admin));
  readonly #wrong = h("p", { class: "wrong", role: "alert", hidden: true });
  readonly #pause: HTMLButtonElement;
  readonly #slider: HTMLInputElement;
  readonly #when: HTMLOutputElement;
  readonly #span = choice<"2" | "10">({
    label: text.span,
    values: text.spans,
    get: () => String(this.#minutes) as "2" | "10",
    set: (value) => {
      this.#minutes = Number(value);
      this.#sync();
    },
  });
  readonly #theme = themeField();
  readonly #numbers = numbersTable();
  readonly #refused = refusedTable();
  #minutes = 2;
  /** How long ago the moment is that is looked at; 0: now. */
  #ago = 0;
  #pointed: number | undefined;

  constructor() {
    this.watch = new Watch(() => this.#sync());
    this.#pause = button(text.pause, () => this.watch.pause(this.watch.state.kind !== "paused"), {
      class: "main",
      "data-load": "pause",
    });
    this.#when = h("output", { for: "load-moment" });
    this.#slider = h("input", { id: "load-moment", type: "range", step: 1, max: 0 });
    this.#slider.addEventListener("input", () => {
      this.#ago = -this.#slider.valueAsNumber;
      this.#sync();
    });
    for (const view of this.#views) {
      view.onPoint = (at) => {
        this.#pointed = at;
        this.#sync();
      };
    }
    const controls = h(
      "div",
      { class: "controls" },
      this.#pause,
      this.#span.element,
      this.#theme.element,
      h(
        "div",
        { class: "field moment" },
        h("label", { for: "load-moment" }, text.moment),
        this.#when,
        this.#slider,
      ),
    );
    const says = h("div", { class: "says" }, this.#state, this.#facts);
    this.element = h(
      "main",
      { class: "load", id: "load" },
      h("div", { class: "top" }, says, controls),
      this.#wrong,
      this.#hint,
      h("div", { class: "charts" }, ...this.#views.map(({ element }) => element)),
      h("div", { class: "tables" }, this.#numbers.element, this.#refused.element),
    );
    this.#sync();
  }

  /** It is looked at, or not; then it asks nothing. */
  show(shown: boolean): void {
    this.watch.run(shown);
  }

  #sync(): void {
    const { state, load, moments: all } = this.watch;
    const paused = state.kind === "paused";
    this.element.dataset["state"] = state.kind;
    const said = text.states[state.kind];
    write(this.#state, said);
    this.#state.dataset["state"] = state.kind;
    write(this.#pause, paused ? text.goOn : text.pause);
    this.#hint.hidden = state.kind !== "hidden";
    write(this.#facts, load ? factsOf(load) : "");
    const wrong = load ? wrongOf(load) : "";
    write(this.#wrong, wrong);
    this.#wrong.hidden = wrong === "";

    // While it is paused, time stands.
    const to = paused || state.kind !== "live" ? (all.at(-1)?.at ?? 1) : performance.now();
    const from = to - this.#minutes * 60_000;
    const moments = all.filter(({ at }) => at >= from);
    const looked = this.#pointed ?? (this.#ago > 0 ? to - 1000 * this.#ago : undefined);
    const moment = looked === undefined ? moments.at(-1) : nearest(moments, looked);
    const ago = moment && looked !== undefined ? (to - moment.at) / 1000 : 0;
    this.#slider.min = String(-60 * this.#minutes);
    if (this.#pointed !== undefined) this.#slider.value = String(-Math.round(ago));
    else this.#slider.value = String(-this.#ago);
    const when = text.ago(ago);
    this.#when.textContent = when;
    this.#slider.setAttribute("aria-valuetext", when);
    const span = { from, to, minutes: this.#minutes, cursor: looked !== undefined };
    this.#span.sync();
    this.#theme.sync();
    this.#views.forEach((view, i) => view.sync(i, moments, moment, span));
    this.#numbers.sync(moments);
    this.#refused.sync(this.watch.first, load);
  }
}

function nearest(moments: readonly Moment[], at: number): Moment | undefined {
  return moments.reduce<Moment | undefined>(
    (best, one) => (best && Math.abs(best.at - at) <= Math.abs(one.at - at) ? best : one),
    undefined,
  );
}

function factsOf({ at, gateway, server }: Load): string {
  const up = (startedAt: number): string => text.duration(Math.max(0, (at - startedAt) / 1000));
  return server ? text.facts(server.version, up(server.startedAt), up(gateway.startedAt)) : "";
}

const wrongOf = ({ server, serverProblem }: Load): string =>
  serverProblem ?? (server?.weaknesses.length ? text.weakness(server.weaknesses.join(", ")) : "");

function table(title: string, heads: readonly string[], body: HTMLElement): HTMLElement {
  return h(
    "section",
    {},
    h("h2", {}, title),
    h(
      "table",
      { "aria-label": title },
      h("thead", {}, h("tr", {}, ...heads.map((head) => h("th", { scope: "col" }, head)))),
      body,
    ),
  );
}

function numbersTable(): { element: HTMLElement; sync(moments: readonly Moment[]): void } {
  const rows = charts.flatMap(({ key, unit, lines }, chart) =>
    lines.map((line, i) => {
      const cells = [h("td", {}), h("td", {})];
      const name = text.chart(text.charts[key], text.lines[line.key]);
      return { chart, i, unit, cells, row: h("tr", {}, h("th", { scope: "row" }, name), ...cells) };
    }),
  );
  return {
    element: table(text.table, text.columns, h("tbody", {}, ...rows.map(({ row }) => row))),
    sync(moments) {
      for (const { chart, i, unit, cells } of rows) {
        const values = moments
          .map(({ values: all }) => all[chart][i])
          .filter((value) => !Number.isNaN(value));
        const say = (value: number): string =>
          values.length > 0 ? text.units[unit](value) : text.nothing;
        const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
        write(cells[0], say(mean));
        write(cells[1], say(values.reduce((most, value) => Math.max(most, value), 0)));
      }
    },
  };
}

function refusedTable(): {
  element: HTMLElement;
  sync(first: Load | undefined, now: Load | undefined): void;
} {
  const body = h("tbody", {});
  let shown = "";
  return {
    element: table(text.refused, text.refusedColumns, body),
    sync(first, now) {
      const rows = [
        ...grown(first?.gateway.problems, now?.gateway.problems, text.by.gateway),
        ...grown(first?.server?.rejected, now?.server?.rejected, text.by.server),
      ];
      const said = JSON.stringify(rows);
      if (said === shown) return;
      shown = said;
      const none = h("tr", {}, h("td", { colspan: 3 }, text.refusedNone));
      body.replaceChildren(
        ...(rows.length === 0
          ? [none]
          : rows.map(([reason, by, count]) =>
              h(
                "tr",
                {},
                h("th", { scope: "row" }, reason),
                h("td", {}, by),
                h("td", {}, text.units.count(count)),
              ),
            )),
      );
    },
  };
}

function grown(
  before: Record<string, number> | undefined,
  now: Record<string, number> | undefined,
  by: string,
): [reason: string, by: string, count: number][] {
  return Object.entries(now ?? {})
    .map(([reason, count]): [string, string, number] => {
      const more = count - (before?.[reason] ?? 0);
      // Below what was before: it was started anew.
      return [reason, by, more < 0 ? count : more];
    })
    .filter(([, , count]) => count > 0)
    .sort((a, b) => b[2] - a[2]);
}
