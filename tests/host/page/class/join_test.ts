import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { cleanCode, cleanName, codeInHash, problemOfAnswer, problemOfWish, readAnswer } from '../../../../host/page/source/class/join.js';

const answer = { seat: 3, name: 'Anna', path: '/robots/3/', token: 't', key: 'k' };
const wish = { name: 'Anna', code: '000000', key: 'k' };

describe('what a learner writes', () => {
  it('has its name in one composed form, with single spaces', () => {
    assert.equal(cleanName('  A\u0308nne \t Marie '), 'Änne Marie');
    assert.equal(cleanName(' \n '), '');
  });

  it('has the digits of its code', () => {
    assert.equal(cleanCode(' 482 913 '), '482913');
    assert.equal(cleanCode('48-29-13-7'), '482913');
  });

  it('is judged before it is sent', () => {
    assert.equal(problemOfWish('', '482913', true)?.field, 'name');
    assert.equal(problemOfWish('x'.repeat(41), '482913', true)?.field, 'name');
    assert.equal(problemOfWish('🐛'.repeat(40), '482913', true), null);
    assert.equal(problemOfWish('Anna', '4829', true)?.field, 'code');
    assert.equal(problemOfWish('Anna', '', false), null, 'with a key');
  });
});

describe('the link for learners', () => {
  it('has the code', () => {
    assert.equal(codeInHash('#join=482913'), '482913');
    for (const hash of ['', '#join=', '#join=48291', '#join=4829133', '#482913', '#join=48291x']) assert.equal(codeInHash(hash), null, hash);
  });
});

describe('the answer of the program', () => {
  it('is read', () => {
    assert.deepEqual(readAnswer(JSON.stringify(answer)), answer);
  });

  it('leads only to a seat', () => {
    for (const path of ['//other.org/', 'https://other.org/', 'javascript:alert(1)', '/robots/3', '/robots/3/../', 7, null]) {
      assert.equal(readAnswer(JSON.stringify({ ...answer, path })), null, String(path));
    }
    for (const body of ['', 'null', '7', '{}', JSON.stringify({ ...answer, key: 5 })]) assert.equal(readAnswer(body), null, body);
  });

  it('becomes one line at the field that it concerns', () => {
    const line = JSON.stringify({ error: "somebody has the name 'Anna' already" });
    assert.deepEqual(problemOfAnswer(409, line, wish), { field: 'name', text: "Somebody has the name 'Anna' already." });
    assert.equal(problemOfAnswer(400, line, wish).field, 'name');
    assert.deepEqual(problemOfAnswer(413, 'too large', wish), { field: 'name', text: 'The name is too long.' });
    assert.match(problemOfAnswer(403, line, wish).text, /not the code/);
    assert.match(problemOfAnswer(403, line, { ...wish, code: '' }).text, /no robot of this name any more/);
    assert.equal(problemOfAnswer(403, line, wish).field, 'code');
    const ofServer = "Origin: found 'https://x.example', expected that of the Host, 'https://y.example'.\n\nThis page has only...";
    assert.deepEqual(problemOfAnswer(403, ofServer, wish), { field: 'button', text: ofServer.split('\n')[0] });
    assert.equal(problemOfAnswer(429, line, wish).field, 'code');
    assert.equal(problemOfAnswer(503, line, wish).field, 'button');
    assert.match(problemOfAnswer(502, '<html>', wish).text, /answered 502/);
  });
});
