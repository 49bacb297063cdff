// What is selected in the plots: its marks in each of them, and the list of its numbers.

const MARK_RADIUS = 4;

/** Draw a ring at each place, light on dark, so that it shows on every picture. */
function drawMarks(context, { colours }, places) {
  for (const [width, colour] of [[3, colours("paper")], [1.5, colours("ink")]]) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.beginPath();
    for (const [x, y] of places) {
      context.moveTo(x + MARK_RADIUS, y);
      context.arc(x, y, MARK_RADIUS, 0, 2 * Math.PI);
    }
    context.stroke();
  }
}
