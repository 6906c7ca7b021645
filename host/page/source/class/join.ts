// What a learner writes to join a class, and what the program answers.

export const mostNameCharacters = 40;
const codeDigits = 6;

export interface JoinWish {
  name: string;
  code: string;
  key: string;
}

export interface JoinAnswer {
  seat: number;
  name: string;
  path: string;
  token: string;
  key: string;
}

// One line about a field, or about the whole form: then it stands at the button.
export interface JoinProblem {
  field: 'name' | 'code' | 'button';
  text: string;
}

// The code in the fragment of a link for learners, `#join=482913`; null: there is none.
export function codeInHash(hash: string): string | null {
  return /^#join=(\d{6})$/.exec(hash)?.[1] ?? null;
}

// Keyboards differ in how they compose letters with accents.
export function cleanName(text: string): string {
  return text.normalize('NFC').trim().replace(/\s+/g, ' ');
}

// The digits: many people write "482 913".
export function cleanCode(text: string): string {
  return text.replace(/\D/g, '').slice(0, codeDigits);
}

// `needsCode`: there is no key for this name.
export function problemOfWish(name: string, code: string, needsCode: boolean): JoinProblem | null {
  if (name === '') return { field: 'name', text: 'Write your name.' };
  if ([...name].length > mostNameCharacters) return { field: 'name', text: `A name has at most ${mostNameCharacters} characters.` };
  if (needsCode && code.length !== codeDigits) return { field: 'code', text: `The code has ${codeDigits} digits.` };
  return null;
}

// The line of the program; the status if it has sent none.
function errorIn(status: number, body: string): string {
  try {
    const { error } = JSON.parse(body) as { error?: unknown };
    if (typeof error === 'string' && error !== '') return `${error.charAt(0).toUpperCase()}${error.slice(1)}.`;
  } catch {
    // Not every answer is JSON.
  }
  return `The class answered ${status}. Try again, or ask your teacher.`;
}

export function problemOfAnswer(status: number, body: string, wish: JoinWish): JoinProblem {
  switch (status) {
    case 400:
    case 409:
      return { field: 'name', text: errorIn(status, body) };
    case 413:
      return { field: 'name', text: 'The name is too long.' };
    case 403:
      // Not of the class, but of its server: the way to it is not set up.
      if (body.startsWith('Origin: ')) return { field: 'button', text: body.split('\n', 1)[0] ?? body };
      return {
        field: 'code',
        text: wish.code === '' ? 'This computer has no robot of this name any more. Write the code.' : 'This is not the code. Your teacher shows it.',
      };
    case 429:
      return { field: 'code', text: 'Too many wrong codes. Wait a minute, then try again.' };
    default:
      return { field: 'button', text: errorIn(status, body) };
  }
}

// Null: it is not what the program sends. The path becomes an address, so it must be one of a seat.
export function readAnswer(body: string): JoinAnswer | null {
  try {
    const answer = JSON.parse(body) as Partial<Record<keyof JoinAnswer, unknown>> | null;
    const texts = [answer?.name, answer?.path, answer?.token, answer?.key];
    const isComplete = texts.every((text) => typeof text === 'string') && /^\/robots\/\d+\/$/.test(answer?.path as string);
    return isComplete ? (answer as JoinAnswer) : null;
  } catch {
    return null;
  }
}
