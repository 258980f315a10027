// How tests of the page wait: each wait has a deadline, and then says what it waited for.
import {test as endlessTest} from "node:test";

const DEADLINE_S = 240;  // ctest ends all of them after 900 s, without a word

/** As that of node:test: a test that goes on is ended, and named. */
export const test = (name, body) => endlessTest(name, {timeout: DEADLINE_S * 1000}, body);

/** What a promise gives. Fails if that takes longer than `limit_s`; `what` completes "waited in vain for". */
export async function within(what, promise, limit_s = 120) {
  let timer;
  const late = new Promise((_, failed) => {
    timer = setTimeout(() => failed(new Error(`waited ${limit_s} s in vain for ${what}`)), limit_s * 1000);
  });
  try {
    return await Promise.race([promise, late]);
  } finally {
    clearTimeout(timer);
  }
}
