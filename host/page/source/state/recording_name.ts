// The name of a new recording: of the scenario, and when it began.
export function recordingName(scenarioFile: string, time: Date): string {
  const two = (value: number) => String(value).padStart(2, '0');
  const date = `${time.getFullYear()}${two(time.getMonth() + 1)}${two(time.getDate())}`;
  const clock = `${two(time.getHours())}${two(time.getMinutes())}${two(time.getSeconds())}`;
  return `${scenarioFile.replace(/(\.simulation)?\.xml$/, '')}-${date}-${clock}.proleg`;
}
