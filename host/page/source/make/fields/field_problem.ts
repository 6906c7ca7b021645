// Which field of a form a refusal is about.

export interface FieldProblem {
  field: string; // '': none
  text: string;
}

// A refusal of a form begins with its field: "parameters.0.minimum: found ..., expected ...".
export function fieldProblem(refusal: string): FieldProblem {
  const match = /^([a-z]+(?:\.\d+(?:\.[a-z]+)?)?): (.*)$/.exec(refusal);
  return match === null ? { field: '', text: refusal } : { field: match[1] as string, text: match[2] as string };
}
