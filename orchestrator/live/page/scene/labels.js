// Texts above the picture, none of which stands on another: each has some places where it may stand, and takes the
// first that is free, or is left out. What matters most takes its place first.

const HEIGHT_PX = {
  above: 10,  // of the line on which a text stands
  below: 3
};
const ROOM_PX = 1;   // around a text
const BAND_PX = 32;  // rows of the picture by which the boxes that are taken are looked up

/**
 * Places around a point: to the right above, left above, ...; `dx` to the side, `dy` above or below. `right`: a text
 * begins (1) or ends (-1) there, or has its middle there (0).
 */
export const around = (dx, dy) => [[1, -1], [-1, -1], [1, 1], [-1, 1], [1, 0], [-1, 0], [0, -1], [0, 1]].map(
    ([right, down]) => ({right, dx: right * dx, dy: down * dy}));

/** The one place in which the line of a text begins at a shift from the point. */
export const at = (dx, dy) => [{right: 1, dx, dy: dy + (HEIGHT_PX.below - HEIGHT_PX.above) / 2}];

export class Labels {
  #bands = new Map();
  #wanted = [];
  #places = new Map();  // name -> index of the place that a text has taken in the picture before
  #size = [0, 0];
  drawn = [];  // {text, box: [left, top, right, bottom]}

  /** Begins a picture of this size, in which the boxes `taken` hold something else. */
  begin(width, height, taken) {
    this.#size = [width, height];
    this.#bands.clear();
    this.#wanted = [];
    this.drawn = [];
    for (const box of taken) this.#take(box);
  }

  /**
   * A text that is wanted at [x, y]. `name` tells it from the others of a picture; `rank`: lower ones come first;
   * `places`: around() or at(); `look`: what `write` gets.
   */
  want(name, rank, [x, y], text, places, look) { this.#wanted.push({name, rank, x, y, text, places, look}); }

  /** Places all texts: widthOf(text, look) and write(left, baseline, text, look) are of the pen. */
  end(widthOf, write) {
    const places = new Map();
    for (const label of this.#wanted.sort((a, b) => a.rank - b.rank)) {
      const {name, text, look} = label, width = widthOf(text, look);
      const before = this.#places.get(name) ?? 0;  // stays where it was, if it can
      const order = label.places.map((_, k) => k).sort((a, b) => (b === before) - (a === before) || a - b);
      const found = order.find((k) => this.#isFree(boxAt(label, label.places[k], width)));
      if (found === undefined) continue;
      const box = boxAt(label, label.places[found], width);
      places.set(name, found);
      this.#take(box);
      this.drawn.push({text, box});
      write(box[0], box[3] - HEIGHT_PX.below, text, look);
    }
    this.#places = places;
  }

  #bandsOf([, top, , bottom]) {
    const bands = [];
    for (let band = Math.floor(top / BAND_PX); band <= Math.floor(bottom / BAND_PX); ++band) bands.push(band);
    return bands;
  }

  #take(box) {
    for (const band of this.#bandsOf(box)) this.#bands.set(band, [...(this.#bands.get(band) ?? []), box]);
  }

  #isFree(box) {
    const [left, top, right, bottom] = box, [width, height] = this.#size;
    if (left < 0 || top < 0 || right > width || bottom > height) return false;
    const isApart = ([l, t, r, b]) =>
        right + ROOM_PX <= l || left - ROOM_PX >= r || bottom + ROOM_PX <= t || top - ROOM_PX >= b;
    return this.#bandsOf(box).every((band) => (this.#bands.get(band) ?? []).every(isApart));
  }
}

/** The box of a label of this width at one of its places. */
function boxAt({x, y}, {right, dx, dy}, width) {
  const left = x + dx -
      (right > 0     ? 0 :
           right < 0 ? width :
                       width / 2),
        middle = y + dy, half = (HEIGHT_PX.above + HEIGHT_PX.below) / 2;
  return [left, middle - half, left + width, middle + half];
}
