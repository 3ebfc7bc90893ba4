"use strict";

const assert = require("node:assert");
const test = require("node:test");
const { loadGrammar, tokens } = require("./tokens");

const SAMPLES = [
  [
    "P0010 MOVEJ_RPY_LSPB {TCP} 0 -1.5 [V 25] (mm, deg) {B} BLEND 5 ! a comment",
    [
      ["P0010", "entity.name.label"],
      ["MOVEJ", "support.function"],
      ["_RPY_LSPB", "support.function.suffix"],
      ["{TCP}", "entity.name.namespace.frame"],
      ["0", "constant.numeric"],
      ["-", "keyword.operator"],
      ["1.5", "constant.numeric"],
      ["V", "constant.language"],
      ["25", "constant.numeric"],
      ["mm", "support.type.unit"],
      ["deg", "support.type.unit"],
      ["{B}", "entity.name.namespace.frame"],
      ["BLEND", "keyword.control.option"],
      ["5", "constant.numeric"],
      ["! a comment", "comment.line.exclamation"],
    ],
  ],
  ["  repeat I 4", [["repeat", "keyword.control"], ["4", "constant.numeric"]]],
  [
    "LET A = MIN(B, 3 (mm)) + SIN($C)",
    [
      ["LET", "keyword.control.declaration"],
      ["=", "keyword.operator"],
      ["MIN", "support.function.builtin"],
      ["3", "constant.numeric"],
      ["mm", "support.type.unit"],
      ["+", "keyword.operator"],
      ["SIN", "support.function.builtin"],
      ["$C", "variable.other"],
    ],
  ],
  ['P0020 HOLD "set {it} ! down"', [["P0020", "entity.name.label"], ["HOLD", "support.function"], ['"set {it} ! down"', "string.quoted.double"]]],
  ["P0030 CALL PALLET.SET 4", [["P0030", "entity.name.label"], ["CALL", "support.function"], ["4", "constant.numeric"]]],
  ["MOVEMENT SETTING ENDING", []],
];

for (const [line, expected] of SAMPLES) {
  test(line, async () => {
    const [found] = tokens(await loadGrammar(), line);
    const named = found
      .filter(([, , scope]) => scope !== "source")
      .map(([start, end, scope]) => [line.slice(start, end), scope]);
    assert.deepStrictEqual(named, expected);
  });
}
