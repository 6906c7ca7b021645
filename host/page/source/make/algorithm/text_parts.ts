// A text in parts that fit into a message to the program each, whatever its characters are.

// A message has at most 64 KiB, and a character at most six bytes of it.
const longestPart = 10_000;

export function textParts(text: string, longest: number = longestPart): string[] {
  const parts: string[] = [];
  for (let begin = 0; begin < text.length; ) {
    let end = Math.min(begin + longest, text.length);
    const last = text.charCodeAt(end - 1);
    const isFirstHalf = last >= 0xd800 && last < 0xdc00; // of a character that takes two
    if (isFirstHalf && end < text.length) end -= 1;
    parts.push(text.slice(begin, end));
    begin = end;
  }
  return parts.length === 0 ? [''] : parts;
}
