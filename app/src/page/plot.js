// ---- plots over time

const LEFT = 54, RIGHT = 10, TOP = 8;

/** One plot over time with a cursor at the moment; time grows to the right whichever way the run went. */
class Plot {
  constructor(parent, title, series, logarithmic) {
    Object.assign(this, { series, logarithmic });
    this.figure = add(parent, 'figure');
    const caption = add(this.figure, 'figcaption');
    add(caption, 'b', title);
    for (const curve of series) {
      const reading = add(caption, 'span', '', { class: 'reading' });
      if (curve.label || curve.run.ghost) add(reading, 'span', '', { class: curve.run.ghost ? 'swatch dashed' : 'swatch', style: `--colour: var(--${curve.colour})` });
      add(reading, 'span', curve.label);
      curve.output = add(reading, 'output', '', { 'aria-live': 'off' });
    }
    const canvas = sharpCanvas(this, add(this.figure, 'div', '', { class: 'sheet' }), `${title} over time`);
    this.still = document.createElement('canvas'); // all but the cursor, which alone is drawn anew in each frame
    onDrag(canvas, event => seek(earliest + (event.offsetX - LEFT) / this.span * duration));
  }

  get span() { return Math.max(1, this.width - LEFT - RIGHT); }
  get bottom() { return this.height - (this.last ? 26 : 6); }

  x(time) { return LEFT + (duration > 0 ? (time - earliest) / duration : 0.5) * this.span; }

  y(value) {
    const level = this.logarithmic ? Math.log10(Math.abs(value)) : value;
    const part = clamp((level - this.low) / (this.high - this.low), 0, 1); // zero has no logarithm: it is at the bottom
    return this.bottom - part * (this.bottom - TOP);
  }

  /** A series as [time, value]; of errors the largest in each pixel: the dips between would only blacken the plot. */
  curve({ values, run }) {
    const tops = [];
    run.times.forEach((time, k) => {
      const column = Math.round(this.x(time)), value = values[k] ?? null, top = tops.at(-1);
      const size = this.logarithmic && value !== null ? Math.abs(value) : value;
      if (!this.logarithmic || top?.column !== column) tops.push({ column, at: [time, size] });
      else if (size !== null && !(top.at[1] >= size)) top.at = [time, size];
    });
    return tops.map(top => top.at);
  }

  /** Chooses what the vertical axis spans. */
  measure(curves) {
    const values = curves.flatMap(curve => curve.map(([, value]) => value)).filter(value => value !== null);
    const levels = this.logarithmic ? values.filter(value => value > 0).map(Math.log10) : values;
    const [low, high] = [Math.min, Math.max].map(pick => levels.length ? levels.reduce((a, b) => pick(a, b)) : -16);
    // what varies by no more than rounding is a constant
    const size = Math.max(Math.abs(low), Math.abs(high));
    const margin = high - low > 1e-9 * size ? 0.06 * (high - low) : 0.1 * size || 1;
    const top = Math.max(Math.floor(high) + 1, Math.floor(low) + 2);
    [this.low, this.high] = this.logarithmic ? [Math.max(Math.floor(low), top - 18), top] : [low - margin, high + margin];
  }

  /** The levels that are marked, with their names. */
  levels() {
    const height = Math.max(1, this.bottom - TOP);
    if (!this.logarithmic) return ticks(this.low, this.high, height / 30).map(value => [value, short(value)]);
    const levels = [], stride = Math.ceil((this.high - this.low) * 22 / height);
    for (let power = this.high; power >= this.low; power -= stride) levels.push([10 ** power, `1e${power}`.replace('-', '−')]);
    return levels;
  }

  drawStill() {
    Object.assign(this.still, { width: this.canvas.width, height: this.canvas.height });
    const pen = this.still.getContext('2d');
    pen.scale(this.ratio, this.ratio);
    const curves = this.series.map(series => this.curve(series));
    this.measure(curves);
    Object.assign(pen, { font: '11px system-ui, sans-serif', fillStyle: theme.muted, strokeStyle: theme.line, textAlign: 'right' });
    for (const [value, text] of this.levels()) {
      const y = Math.round(this.y(value)) + 0.5;
      pen.moveTo(LEFT, y);
      pen.lineTo(LEFT + this.span, y);
      pen.fillText(text, LEFT - 7, y + 4);
    }
    const marks = duration > 0 ? ticks(earliest, latest, this.span / 80) : [earliest];
    pen.textAlign = 'center';
    marks.forEach((time, k) => {
      const x = Math.round(this.x(time)) + 0.5;
      pen.moveTo(x, TOP);
      pen.lineTo(x, this.bottom);
      const text = short(time) + (k === marks.length - 1 ? ' s' : '');
      if (this.last) pen.fillText(text, Math.min(x, this.width - pen.measureText(text).width / 2), this.height - 8);
    });
    pen.stroke();
    Object.assign(pen, { lineWidth: 1.4, lineJoin: 'round' });
    curves.forEach((curve, k) => {
      pen.strokeStyle = theme[this.series[k].colour];
      pen.setLineDash(this.series[k].run.ghost ? [5, 4] : []);
      pen.beginPath();
      curve.forEach(([time, value], at) => {
        const joined = at > 0 && curve[at - 1][1] !== null;
        if (value !== null) pen[joined ? 'lineTo' : 'moveTo'](this.x(time), this.y(value));
      });
      pen.stroke();
    });
    this.stale = false;
  }

  draw() {
    if (this.stale) this.drawStill();
    const pen = this.pen, x = this.x(currentTime());
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.still, 0, 0);
    pen.scale(this.ratio, this.ratio);
    pen.fillStyle = theme.ink;
    pen.fillRect(x - 0.5, TOP, 1, this.bottom - TOP);
    for (const { values, run, output, colour } of this.series) {
      // an error between samples is no one's: the reading is that of the sample
      const { index, fraction } = run.moment, before = values[index] ?? null, after = values[index + 1] ?? null;
      const value = this.logarithmic || before === null || after === null ? before : before + (after - before) * fraction;
      output.textContent = short(value);
      if (value === null) continue;
      pen.beginPath();
      pen.arc(x, this.y(value), run.ghost ? 2.5 : 3.5, 0, 2 * Math.PI);
      Object.assign(pen, { lineWidth: 1.5, fillStyle: theme[colour], strokeStyle: theme.panel });
      pen.fill();
      pen.stroke();
    }
  }
}

/** What can be plotted: plots of the same name in several runs are one. Those of errors are always shown, of the others what is chosen. */
const sheets = new Map();
let plots = [];

function collectSheets() {
  for (const run of runs) {
    for (const { name, unit, scale, shown, series } of run.plots) {
      const sheet = sheets.get(name) ?? { name, unit, logarithmic: scale === 'log', shown, curves: [] };
      sheets.set(name, sheet);
      for (const [k, { name: label, colour, values }] of (series ?? []).entries())
        sheet.curves.push({ label: label ?? '', colour: colour ?? 'c' + k % 7, values: values ?? [], run, chosen: false });
    }
  }
  const asked = [...sheets.values()].filter(({ shown }) => shown), linear = [...sheets.values()].filter(({ logarithmic }) => !logarithmic);
  for (const { curves } of asked.length ? asked : linear.slice(0, 1)) for (const curve of curves) curve.chosen = true;
}

function setUpPlots() {
  collectSheets();
  byId('curves').hidden = !sheets.size;
  byId('choice').hidden = ![...sheets.values()].some(({ logarithmic }) => !logarithmic);
  for (const { name, logarithmic, curves } of sheets.values()) {
    if (logarithmic) continue;
    const set = add(byId('choice'), 'fieldset');
    const own = curves.filter(({ run }) => !run.ghost);
    if (own.length > 1 || own[0]?.label) add(set, 'legend', spoken(name), { class: 'faint' });
    for (const { label, colour } of own) {
      const chip = add(set, 'label', label || spoken(name), { class: 'chip', style: `--colour: var(--${colour})` });
      const box = add(chip, 'input', '', { type: 'checkbox', 'aria-label': `${spoken(name)} ${label}` });
      const same = curves.filter(curve => curve.label === label);
      box.checked = same[0].chosen;
      box.addEventListener('change', () => {
        for (const curve of same) curve.chosen = box.checked;
        arrangePlots();
      });
    }
  }
  arrangePlots();
}

function arrangePlots() {
  const parent = byId('plots');
  parent.replaceChildren();
  plots = [];
  for (const { name, unit, logarithmic, curves } of sheets.values()) {
    const series = logarithmic ? curves : curves.filter(({ chosen }) => chosen);
    if (series.length) plots.push(new Plot(parent, withUnit(spoken(name), unit), series, logarithmic));
  }
  if (!plots.length) return add(parent, 'p', 'Nothing is chosen to be plotted.', { class: 'faint' });
  plots.at(-1).last = true; // it bears the times
  plots.at(-1).figure.classList.add('last');
}
