// Moves the line between two pictures, one over the other, with the slider below them.

for (const wiped of document.querySelectorAll(".wiped")) {
  const stage = wiped.querySelector(".stage");
  const slider = wiped.querySelector("input");
  const update = () => stage.style.setProperty("--wipe", `${slider.value}%`);
  slider.addEventListener("input", update);
  stage.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    const box = stage.getBoundingClientRect();
    slider.value = (100 * (event.clientX - box.left)) / box.width;
    update();
  });
}
