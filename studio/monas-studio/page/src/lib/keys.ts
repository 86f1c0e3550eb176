/** Inputs that take no text: keys mean the same there as elsewhere. */
const WITHOUT_TEXT = ['range', 'checkbox', 'radio', 'button', 'file'];

/** Whether an element handles a pressed key itself: it is typed there, or selects an option. */
export function isWritten(target: HTMLElement): boolean {
  if (target instanceof HTMLInputElement) {
    return !WITHOUT_TEXT.includes(target.type);
  }
  return target.isContentEditable || /^(SELECT|TEXTAREA)$/.test(target.tagName);
}

/** Whether the space bar presses an element. */
export function isPressed(target: HTMLElement): boolean {
  const isSwitch = target instanceof HTMLInputElement && target.type !== 'range';
  return isSwitch || /^(BUTTON|SUMMARY)$/.test(target.tagName);
}
