document.getElementById("text").textContent = document.getElementById("report").textContent;
