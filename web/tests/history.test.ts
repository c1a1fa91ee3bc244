import { describe, expect, it } from 'vitest';
import { canRedo, canUndo, change, redo, settle, startHistory, undo } from '../src/model';

describe('history', () => {
  it('goes back and forth', () => {
    let h = change(change(startHistory('a'), 'b'), 'c');
    h = undo(h);
    expect(h.present).toBe('b');
    h = undo(h);
    expect(h.present).toBe('a');
    expect(canUndo(h)).toBe(false);
    h = redo(redo(h));
    expect(h.present).toBe('c');
    expect(canRedo(h)).toBe(false);
  });

  it('makes one entry of each drag', () => {
    let h = startHistory(0);
    for (const x of [1, 2, 3]) h = change(h, x, 'drag 1');
    h = settle(h);
    for (const x of [4, 5]) h = change(h, x, 'drag 2');
    expect(undo(h).present).toBe(3);
    expect(undo(undo(h)).present).toBe(0);
  });

  it('makes two entries of two drags of one name, if settled between', () => {
    const h = change(settle(change(startHistory(0), 1, 'drag')), 2, 'drag');
    expect(undo(h).present).toBe(1);
  });

  it('drops undone changes after a new change', () => {
    const h = change(undo(change(startHistory('a'), 'b')), 'c');
    expect(canRedo(h)).toBe(false);
    expect(undo(h).present).toBe('a');
  });

  it('has a limited length', () => {
    let h = startHistory(0);
    for (let n = 1; n < 1000; n++) h = change(h, n);
    expect(h.past.length).toBeLessThanOrEqual(200);
  });

  it('ignores a change without effect', () => {
    const h = startHistory('a');
    expect(change(h, 'a')).toBe(h);
    expect(undo(h)).toBe(h);
    expect(redo(h)).toBe(h);
  });
});
